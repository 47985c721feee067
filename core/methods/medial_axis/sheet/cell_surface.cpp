#include "core/methods/medial_axis/sheet/cell_surface.h"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "core/methods/medial_axis/sheet/sheet_network.h"

namespace sonoloft::medial {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

std::uint64_t directed(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{a} << 32 | b;
}

/// The labels of triangles as one face has them: given along its contours, the same across all other edges.
/// @param side  0: of face f, 1: of face g
std::vector<std::int32_t> spread_labels(const SheetNetwork& sheet, const Triangles& triangles, std::size_t side) {
  std::vector<std::int32_t> labels(triangles.size(), kNoBorder);
  std::unordered_map<std::uint64_t, std::uint32_t> at_edge;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) at_edge[directed(triangles[t][i], triangles[t][(i + 1) % 3])] = t;
  std::vector<std::uint32_t> fresh;
  const auto give = [&](std::uint64_t edge, std::int32_t label) {
    const auto found = at_edge.find(edge);
    if (found == at_edge.end() || labels[found->second] != kNoBorder) return;
    labels[found->second] = label;
    fresh.push_back(found->second);
  };
  std::unordered_set<std::uint64_t> borders;
  for (const SheetEdge& edge : sheet.edges) {
    if (edge.left[side] == kNoBorder) continue;
    const std::uint64_t there = directed(edge.ends[0], edge.ends[1]), back = directed(edge.ends[1], edge.ends[0]);
    borders.insert({there, back});
    give(there, edge.left[side]);
    give(back, edge.right[side]);
  }
  while (!fresh.empty()) {
    const std::uint32_t t = fresh.back();
    fresh.pop_back();
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint64_t back = directed(triangles[t][(i + 1) % 3], triangles[t][i]);
      if (!borders.contains(back)) give(back, labels[t]);
    }
  }
  return labels;
}

class SurfaceBuilder {
 public:
  SurfaceBuilder(const CurveNetwork& network, std::span<const Facing> faces, std::span<const FaceCurve> edges,
                 double scale_mm)
      : network_(network), axis_(network.planes, faces, scale_mm), curves_(project_curves(network, axis_, edges)) {}

  CellSurface build() {
    std::vector<std::vector<CurveStretch>> stretches(axis_.sheets.size());
    for (std::uint32_t c = 0; c < curves_.curves.size(); ++c)
      for (std::uint32_t i = 0; i < curves_.curves[c].over.size(); ++i)
        if (curves_.curves[c].over[i] != kNoPoint) stretches[curves_.curves[c].over[i]].push_back({c, i});
    for (std::uint32_t s = 0; s < axis_.sheets.size(); ++s) add_sheet(s, stretches[s]);
    for (Curve& curve : curves_.curves) add_wall(curve);
    for (const LabelledTriangle& t : triangles_)
      for (const std::uint32_t v : t.corners)
        if (v < axis_.vertices.size() && axis_.vertices[v].corner)
          curves_.vertices[v].position = canonical(axis_.vertices[v].at);
    return {std::move(curves_.vertices), std::move(triangles_)};
  }

 private:
  std::uint32_t known(std::uint32_t v) const {
    const std::uint32_t same = curves_.vertices[v].same;
    return same == kNoPoint ? v : same;
  }

  /// The label of a face under a sheet on which it has no contour.
  Label label_under(const Sheet& sheet, std::uint32_t face) const {
    const auto at = [&](std::size_t i) { return axis_.vertices[sheet.outline[i]].foot(face); };
    const Point p = at(0), q = at(1), r = at(2);
    const Point inside((p.x() + q.x() + r.x()) / 3, (p.y() + q.y() + r.y()) / 3);
    return network_.label_at(axis_.faces[face].plane, inside, rounded(inside));
  }

  void add_sheet(std::uint32_t s, std::span<const CurveStretch> stretches) {
    const Sheet& sheet = axis_.sheets[s];
    std::array<bool, 2> curved{};
    for (const CurveStretch& stretch : stretches) curved[curves_.curves[stretch.curve].face == sheet.f ? 0 : 1] = true;
    std::array<std::int32_t, 2> label{};
    for (std::size_t side = 0; side < 2; ++side)
      if (!curved[side]) label[side] = label_under(sheet, side == 0 ? sheet.f : sheet.g);
    if (!curved[0] && !curved[1] && label[0] == label[1]) return;

    const SheetNetwork net(network_, axis_, s, stretches, curves_);
    std::vector<std::array<std::uint32_t, 2>> edges;
    for (const SheetEdge& edge : net.edges) edges.push_back(edge.ends);
    const Triangles triangles = triangulate(net.points, edges);
    std::array<std::vector<std::int32_t>, 2> labels;
    for (std::size_t side = 0; side < 2; ++side)
      if (curved[side]) labels[side] = spread_labels(net, triangles, side);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      std::array<std::uint32_t, 3> corners{};
      for (std::size_t i = 0; i < 3; ++i) corners[i] = net.vertices[triangles[t][i]];
      const auto f = static_cast<Label>(curved[0] ? labels[0][t] : label[0]),
                 g = static_cast<Label>(curved[1] ? labels[1][t] : label[1]);
      const bool towards_g = axis_.faces[sheet.f].side > 0;  // the normal of f points into the cell
      if (f != g) triangles_.push_back({corners, towards_g ? g : f, towards_g ? f : g});
    }
  }

  void add_wall(Curve& curve);

  const CurveNetwork& network_;
  CellAxis axis_;
  CellCurves curves_;
  std::vector<LabelledTriangle> triangles_;
};

/// Upright from a contour's piece to the roof. It is convex, since a roof has no valleys: the best of its corners is
/// cut off until nothing is left.
void SurfaceBuilder::add_wall(Curve& curve) {
  std::vector<Waypoint> roof = curve.roof;
  roof.insert(roof.end(), curve.cuts.begin(), curve.cuts.end());
  std::ranges::sort(roof, [](const Waypoint& a, const Waypoint& b) { return a.along > b.along; });
  std::vector<std::uint32_t> loop{curve.a, curve.b};
  for (const Waypoint& w : roof)
    if (known(w.vertex) != loop.back() && known(w.vertex) != loop.front()) loop.push_back(known(w.vertex));
  const auto goodness = [&](std::size_t i) {
    const auto at = [&](std::size_t k) { return curves_.vertices[loop[k % loop.size()]].position; };
    const Eigen::Vector3d p = at(i + loop.size() - 1), q = at(i), r = at(i + 1);
    const double sides = (q - p).squaredNorm() + (r - q).squaredNorm() + (p - r).squaredNorm();
    return sides > 0 ? (q - p).cross(r - q).norm() / sides : 0;
  };
  const NetworkEdge& edge = network_.edges[curve.edge];
  const bool towards_right = axis_.faces[curve.face].side > 0;
  while (loop.size() > 2) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < loop.size() && loop.size() > 3; ++i)
      if (goodness(i) > goodness(best)) best = i;
    const std::size_t n = loop.size();
    triangles_.push_back({{loop[(best + n - 1) % n], loop[best], loop[(best + 1) % n]},
                          towards_right ? edge.right : edge.left,
                          towards_right ? edge.left : edge.right});
    loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(best));
  }
}

}  // namespace

CellSurface surface_of_cell(const CurveNetwork& network, std::span<const Facing> faces,
                            std::span<const FaceCurve> edges, double scale_mm) {
  return SurfaceBuilder(network, faces, edges, scale_mm).build();
}

}  // namespace sonoloft::medial
