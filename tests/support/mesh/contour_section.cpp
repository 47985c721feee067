#include "tests/support/mesh/contour_section.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "core/slice/section.h"

namespace sonoloft::test {
namespace {

constexpr double kSame = 1e-9;

using Edge = std::pair<std::uint32_t, std::uint32_t>;
using Chain = std::map<Label, int>;  ///< how often an edge bounds a label, with its direction

void add(Chain& chain, Label label, int times) {
  if ((chain[label] += times) == 0) chain.erase(label);
}

/// [edge, lower vertex first] what the labels of these triangles leave open.
void add_boundary(std::map<Edge, Chain>& open, const ContourSurfaces& s, std::size_t t, std::size_t corner) {
  const std::uint32_t a = s.triangles[t][corner], b = s.triangles[t][(corner + 1) % 3];
  const int way = a < b ? 1 : -1;
  Chain& chain = open[std::minmax(a, b)];
  add(chain, s.label_front[t], way);
  add(chain, s.label_back[t], -way);
}

double distance_to(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d way = b - a;
  return (p - a - std::clamp((p - a).dot(way) / way.squaredNorm(), 0.0, 1.0) * way).norm();
}

class Slice {
 public:
  Slice(const TrackedSlice& slice, double diagonal_mm) : section_(*make_section(slice)), diagonal_mm_(diagonal_mm) {
    for (std::size_t i = 0; i < section_.edges.size(); ++i)
      if (is_contour(section_.edges[i])) length_mm_ += (end(i) - start(i)).norm();
    order_by_x();
  }

  void compare(const ContourSurfaces& s, ContourSection& out) const {
    const Eigen::Isometry3d to_image = section_.image_to_reference.inverse(Eigen::Isometry);
    std::vector<Eigen::Vector3d> at;
    for (const Eigen::Vector3d& p : s.positions) at.push_back(to_image * p);
    std::map<Edge, Chain> seen[2];
    const double on_mm = kSame * diagonal_mm_;
    for (std::size_t t = 0; t < s.triangles.size(); ++t) {
      double low = 0, high = 0;
      for (const std::uint32_t v : s.triangles[t]) low = std::min(low, at[v].z()), high = std::max(high, at[v].z());
      out.crossings += low < -on_mm && high > on_mm && crosses(s.triangles[t], at);
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = s.triangles[t][i], b = s.triangles[t][(i + 1) % 3];
        if (std::max(a, b) < s.on_slices && std::abs(at[a].z()) <= on_mm && std::abs(at[b].z()) <= on_mm &&
            knows((at[a] + at[b]).head<2>() / 2))
          add_boundary(seen[at[s.triangles[t][(i + 2) % 3]].z() > 0], s, t, i);
      }
    }
    for (int side = 0; side < 2; ++side) compare_side(seen[side], at, side == 1, out);
  }

 private:
  Eigen::Vector2d start(std::size_t e) const { return section_.points[section_.edges[e].a]; }
  Eigen::Vector2d end(std::size_t e) const { return section_.points[section_.edges[e].b]; }
  static bool is_contour(const SectionEdge& e) { return e.left != kUnknown && e.right != kUnknown; }
  bool knows(const Eigen::Vector2d& p) const { return label_at(section_, p) != kUnknown; }
  /// Whether a triangle meets the plane where the slice knows something, looked at in some places.
  bool crosses(const std::array<std::uint32_t, 3>& corners, const std::vector<Eigen::Vector3d>& at) const {
    std::vector<Eigen::Vector2d> ends;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d &p = at[corners[i]], &q = at[corners[(i + 1) % 3]];
      if (p.z() * q.z() < 0) ends.push_back((p + p.z() / (p.z() - q.z()) * (q - p)).head<2>());
      if (p.z() == 0) ends.push_back(p.head<2>());
    }
    constexpr int kPlaces = 16;
    for (int i = 1; i < kPlaces; ++i)
      if (knows(ends.front() + (1.0 * i / kPlaces) * (ends.back() - ends.front()))) return true;
    return false;
  }
  void order_by_x() {
    for (std::uint32_t e = 0; e < section_.edges.size(); ++e) by_x_.push_back({std::min(start(e).x(), end(e).x()), e});
    std::ranges::sort(by_x_);
    for (std::size_t e = 0; e < section_.edges.size(); ++e)
      widest_ = std::max(widest_, std::abs(start(e).x() - end(e).x()));
  }

  void compare_side(const std::map<Edge, Chain>& seen, const std::vector<Eigen::Vector3d>& at, bool above,
                    ContourSection& out) const {
    double length_mm = 0;
    for (const auto& [edge, chain] : seen) {
      if (chain.empty()) continue;
      const Eigen::Vector2d a = at[edge.first].head<2>(), b = at[edge.second].head<2>();
      const double off_mm = off(a, b, chain, above);
      length_mm += (b - a).norm();
      out.strays += off_mm > kSame * diagonal_mm_;
      if (off_mm <= kSame * diagonal_mm_) out.distance = std::max(out.distance, off_mm / diagonal_mm_);
    }
    if (length_mm_ > 0) out.missing = std::max(out.missing, std::abs(length_mm_ - length_mm) / length_mm_);
  }
  /// Distance of an edge from the nearest contour that parts the same labels in the same direction.
  double off(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Chain& chain, bool above) const {
    double least = std::numeric_limits<double>::infinity();
    const double x = std::min(a.x(), b.x());
    const auto first = std::ranges::lower_bound(by_x_, std::pair{x - widest_ - kSame * diagonal_mm_, 0u});
    for (auto e = first; e != by_x_.end() && e->first <= x + kSame * diagonal_mm_; ++e) {
      const SectionEdge& edge = section_.edges[e->second];
      const bool forwards = (b - a).dot(end(e->second) - start(e->second)) > 0;
      // upright walls turn their front to the right of the contour above the slice, to the left of it below
      const int way = forwards == above ? 1 : -1;
      if (chain != Chain{{edge.left, -way}, {edge.right, way}}) continue;
      least = std::min(least, std::max(distance_to(a, start(e->second), end(e->second)),
                                       distance_to(b, start(e->second), end(e->second))));
    }
    return least;
  }

  Section section_;
  double diagonal_mm_, length_mm_ = 0, widest_ = 0;
  std::vector<std::pair<double, std::uint32_t>> by_x_;
};

}  // namespace

bool ContourSection::exact() const {
  return open_edges == 0 && crossings == 0 && strays == 0 && missing < kSame && distance < kSame;
}

std::string ContourSection::text() const {
  std::ostringstream words;
  words << open_edges << " open edges, " << crossings << " crossings, " << strays << " strays, missing " << missing
        << ", off by " << distance;
  return words.str();
}

ContourSection section_with(std::span<const TrackedSlice> slices, const ContourSurfaces& surfaces) {
  ContourSection out;
  std::map<Edge, Chain> open;
  for (std::size_t t = 0; t < surfaces.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) add_boundary(open, surfaces, t, i);
  for (const auto& [edge, chain] : open) out.open_edges += !chain.empty();
  Eigen::AlignedBox3d data;
  for (const TrackedSlice& slice : slices)
    for (const Eigen::Vector2d& p : slice.points)
      data.extend(slice.image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0));
  for (const TrackedSlice& slice : slices) Slice(slice, data.diagonal().norm()).compare(surfaces, out);
  return out;
}

std::map<Label, double> volumes_mm3(const ContourSurfaces& surfaces) {
  std::map<Label, double> volumes;
  for (std::size_t t = 0; t < surfaces.triangles.size(); ++t) {
    const auto at = [&](std::size_t i) { return surfaces.positions[surfaces.triangles[t][i]]; };
    const double below_mm3 = at(0).dot(at(1).cross(at(2))) / 6;
    volumes[surfaces.label_back[t]] += below_mm3;
    volumes[surfaces.label_front[t]] -= below_mm3;
  }
  return volumes;
}

}  // namespace sonoloft::test
