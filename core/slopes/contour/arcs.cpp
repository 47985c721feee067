#include "core/slopes/contour/arcs.h"

#include <algorithm>
#include <array>
#include <utility>

namespace sonoloft {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF;

class ArcBuilder {
 public:
  explicit ArcBuilder(const Section& section)
      : section_(section), next_(section.edges.size(), kNone), has_previous_(section.edges.size(), false) {
    arcs_.place_of_edge.assign(section.edges.size(), kNone);
    for (const Meeting& m : meetings())
      if (m.is_passage()) join(m);
  }

  Arcs build() && {
    const auto edge_count = static_cast<std::uint32_t>(section_.edges.size());
    for (std::uint32_t e = 0; e < edge_count; ++e)
      if (!has_previous_[e]) follow(e);
    for (std::uint32_t e = 0; e < edge_count; ++e)
      if (arcs_.place_of_edge[e] == kNone) follow(e);
    return std::move(arcs_);
  }

 private:
  /// The edges at a point, the first two that come and that go.
  struct Meeting {
    std::array<std::uint32_t, 2> coming{}, going{};
    std::uint32_t comers = 0, goers = 0;
    bool two_labels = true;

    /// Arcs go on here: of one border, or of one that crosses or touches itself.
    [[nodiscard]] bool is_passage() const { return two_labels && comers == goers && comers <= 2; }
  };

  [[nodiscard]] bool is_turned(const SectionEdge& e) const { return e.left < e.right; }
  [[nodiscard]] std::uint32_t start(std::uint32_t e) const {
    const SectionEdge& edge = section_.edges[e];
    return is_turned(edge) ? edge.b : edge.a;
  }
  [[nodiscard]] std::uint32_t end(std::uint32_t e) const {
    const SectionEdge& edge = section_.edges[e];
    return is_turned(edge) ? edge.a : edge.b;
  }
  [[nodiscard]] Eigen::Vector2d way(std::uint32_t e) const {
    return section_.points[end(e)] - section_.points[start(e)];
  }
  [[nodiscard]] bool same_labels(std::uint32_t e, std::uint32_t f) const {
    const auto &a = section_.edges[e], &b = section_.edges[f];
    return std::minmax(a.left, a.right) == std::minmax(b.left, b.right);
  }

  [[nodiscard]] std::vector<Meeting> meetings() const {
    std::vector<Meeting> meetings(section_.points.size());
    const auto note = [](std::uint32_t e, std::array<std::uint32_t, 2>& edges, std::uint32_t& count) {
      if (count < edges.size()) edges[count] = e;
      ++count;
    };
    for (std::uint32_t e = 0; e < section_.edges.size(); ++e) {
      for (const std::uint32_t point : {section_.edges[e].a, section_.edges[e].b}) {
        Meeting& m = meetings[point];
        if (m.comers + m.goers > 0) m.two_labels &= same_labels(e, m.comers > 0 ? m.coming[0] : m.going[0]);
        point == end(e) ? note(e, m.coming, m.comers) : note(e, m.going, m.goers);
      }
    }
    return meetings;
  }

  /// Of two ways through a point the straighter one.
  void join(const Meeting& m) {
    const auto straight = [&](std::uint32_t from, std::uint32_t to) {
      return way(m.coming[from]).stableNormalized().dot(way(m.going[to]).stableNormalized());
    };
    const bool crossed = m.comers == 2 && straight(0, 1) + straight(1, 0) > straight(0, 0) + straight(1, 1);
    for (std::uint32_t i = 0; i < m.comers; ++i) {
      const std::uint32_t next = m.going[crossed ? 1 - i : i];
      next_[m.coming[i]] = next;
      has_previous_[next] = true;
    }
  }

  void add_place(std::uint32_t point, double along_mm) {
    arcs_.arc.push_back(static_cast<std::uint32_t>(arcs_.arcs.size()));
    arcs_.point.push_back(point);
    arcs_.along_mm.push_back(along_mm);
  }

  void follow(std::uint32_t first_edge) {
    const SectionEdge& edge = section_.edges[first_edge];
    Arc arc{std::max(edge.left, edge.right), std::min(edge.left, edge.right), 0, 0, false, 0};
    arc.first = static_cast<std::uint32_t>(arcs_.point.size());
    for (std::uint32_t e = first_edge;;) {
      arcs_.place_of_edge[e] = static_cast<std::uint32_t>(arcs_.point.size());
      add_place(start(e), arc.length_mm);
      arc.length_mm += way(e).norm();
      if (next_[e] == kNone) {
        add_place(end(e), arc.length_mm);
        break;
      }
      e = next_[e];
      if (e != first_edge) continue;
      arc.closed = true;
      break;
    }
    arc.count = static_cast<std::uint32_t>(arcs_.point.size()) - arc.first;
    arcs_.arcs.push_back(arc);
  }

  const Section& section_;
  std::vector<std::uint32_t> next_;  ///< [#edges] in the same arc; kNone where it ends
  std::vector<bool> has_previous_;   ///< [#edges]
  Arcs arcs_;
};

}  // namespace

Arcs arcs_of(const Section& section) {
  return ArcBuilder(section).build();
}

}  // namespace sonoloft
