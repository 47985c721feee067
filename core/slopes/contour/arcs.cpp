#include "core/slopes/contour/arcs.h"

#include <algorithm>
#include <utility>

namespace sonoloft {
namespace {

constexpr std::uint32_t kNotYet = 0xFFFFFFFF;

class ArcBuilder {
 public:
  explicit ArcBuilder(const Section& section)
      : section_(section), meeting_(section.points.size(), 0), leaving_(section.points.size(), kNotYet) {
    arcs_.place_of_edge.assign(section.edges.size(), kNotYet);
    for (std::uint32_t e = 0; e < section.edges.size(); ++e) {
      ++meeting_[section.edges[e].a];
      ++meeting_[section.edges[e].b];
      leaving_[start(e)] = e;
    }
  }

  Arcs build() && {
    const auto edge_count = static_cast<std::uint32_t>(section_.edges.size());
    for (std::uint32_t e = 0; e < edge_count; ++e)
      if (meeting_[start(e)] != 2) follow(e);
    for (std::uint32_t e = 0; e < edge_count; ++e)
      if (arcs_.place_of_edge[e] == kNotYet) follow(e);
    return std::move(arcs_);
  }

 private:
  [[nodiscard]] bool is_turned(const SectionEdge& e) const { return e.left < e.right; }
  [[nodiscard]] std::uint32_t start(std::uint32_t e) const {
    const SectionEdge& edge = section_.edges[e];
    return is_turned(edge) ? edge.b : edge.a;
  }
  [[nodiscard]] std::uint32_t end(std::uint32_t e) const {
    const SectionEdge& edge = section_.edges[e];
    return is_turned(edge) ? edge.a : edge.b;
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
      arc.length_mm += (section_.points[end(e)] - section_.points[start(e)]).norm();
      if (meeting_[end(e)] != 2) {
        add_place(end(e), arc.length_mm);
        break;
      }
      e = leaving_[end(e)];
      if (e != first_edge) continue;
      arc.closed = true;
      break;
    }
    arc.count = static_cast<std::uint32_t>(arcs_.point.size()) - arc.first;
    arcs_.arcs.push_back(arc);
  }

  const Section& section_;
  std::vector<std::uint32_t> meeting_;  ///< [#points] edges that end there
  std::vector<std::uint32_t> leaving_;  ///< [#points] one of the edges that start there
  Arcs arcs_;
};

}  // namespace

Arcs arcs_of(const Section& section) {
  return ArcBuilder(section).build();
}

}  // namespace sonoloft
