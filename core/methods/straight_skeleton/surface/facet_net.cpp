#include "core/methods/straight_skeleton/surface/facet_net.h"

#include <algorithm>
#include <map>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "core/methods/network/planar_sweep.h"

namespace sonoloft::skeleton {
namespace {

std::uint64_t directed(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{a} << 32 | b;
}

}  // namespace

bool is_before(const Corner& p, const Corner& q, std::size_t axis, double doubt_mm) {
  const auto i = static_cast<Eigen::Index>(axis);
  const double by_mm = q.rough[i] - p.rough[i];
  return std::abs(by_mm) > doubt_mm ? by_mm > 0 : network::sign_of(q.at()[axis] - p.at()[axis]) > 0;
}

std::size_t axis_of_line(const Form& f, const Form& g) {
  const Eigen::Vector3d m = f.rough.head<3>().normalized(), n = g.rough.head<3>().normalized();
  Eigen::Index axis = 0;
  m.cross(n).cwiseAbs().maxCoeff(&axis);
  return static_cast<std::size_t>(axis);
}

FacetNet::FacetNet(const Space& space, const Facet& facet)
    : space_(space), facet_(facet), doubt_mm_(space.box.doubt_mm) {
  points = facet.polygon.corners;
  const auto n = static_cast<std::uint32_t>(points.size());
  for (std::uint32_t i = 0; i < n; ++i) lines.push_back({facet.polygon.sides[i], 0, {i, (i + 1) % n}});
  if (facet.curve != nullptr) return;
  const auto footing_of = [&](const Owner& owner) -> const Footing& {
    return space.fronts[owner.front].footings[owner.cell->footing];
  };
  add_chords(footing_of(facet.negative), 1);
  add_chords(footing_of(facet.positive), 2);
  for (std::size_t i = n; i < lines.size(); ++i)
    for (std::size_t k = i + 1; k < lines.size(); ++k) meet_lines(lines[i], lines[k]);
}

std::uint32_t FacetNet::add_point(const Corner& corner) {
  const auto found = std::ranges::find_if(points, [&](const Corner& p) { return p.is_at(corner); });
  const auto at = static_cast<std::uint32_t>(found - points.begin());
  if (found == points.end()) points.push_back(corner);
  return at;
}

void FacetNet::add_chords(const Footing& footing, unsigned borders) {
  for (const Curve& curve : footing.curves) {
    RoughPolygon near(facet_.polygon, doubt_mm_);
    if (near.cut(curve.line->rough) && near.cut(-curve.line->rough) &&
        std::ranges::all_of(curve.ends, [&](const FormPtr& end) { return near.cut(end->rough); }))
      add_chord(curve, borders);
  }
}

void FacetNet::add_chord(const Curve& curve, unsigned borders) {
  const Polygon& polygon = facet_.polygon;
  const std::size_t n = polygon.corners.size();
  std::vector<int> at(n);
  for (std::size_t i = 0; i < n; ++i) at[i] = side_of(*curve.line, polygon.corners[i], doubt_mm_);
  struct End {
    Corner corner;
    std::optional<std::size_t> side;  ///< of the outline, on which it lies within
  };
  std::vector<End> ends;
  for (std::size_t i = 0; i < n; ++i) {
    const int next = at[(i + 1) % n];
    if (at[i] == 0 && next == 0) return;  // along the outline, which has its own labels on both sides
    if (at[i] == 0) ends.push_back({polygon.corners[i], std::nullopt});
    if (at[i] * next < 0) ends.push_back({Corner(polygon.support, polygon.sides[i], curve.line, doubt_mm_), i});
  }
  if (ends.size() != 2) return;
  for (const FormPtr& bound : curve.ends) {
    const int first = side_of(*bound, ends[0].corner, doubt_mm_), second = side_of(*bound, ends[1].corner, doubt_mm_);
    if (first <= 0 && second <= 0 && (first < 0 || second < 0)) return;
    if (first * second < 0)
      ends[first < 0 ? 0 : 1] = {Corner(polygon.support, curve.line, bound, doubt_mm_), std::nullopt};
  }
  Line line{curve.line, borders, {}};
  for (const End& end : ends) {
    line.at.push_back(add_point(end.corner));
    if (end.side) lines[*end.side].at.push_back(line.at.back());
  }
  lines.push_back(std::move(line));
}

void FacetNet::meet_lines(Line& f, Line& g) {
  const auto box_of = [&](const Line& line) {
    Eigen::AlignedBox3d box(points[line.at[0]].rough);
    box.extend(points[line.at[1]].rough);
    box.min().array() -= doubt_mm_, box.max().array() += doubt_mm_;
    return box;
  };
  if (!box_of(f).intersects(box_of(g))) return;
  const std::array fs{side_of(*g.form, points[f.at[0]], doubt_mm_), side_of(*g.form, points[f.at[1]], doubt_mm_)};
  const std::array gs{side_of(*f.form, points[g.at[0]], doubt_mm_), side_of(*f.form, points[g.at[1]], doubt_mm_)};
  if (fs[0] * fs[1] > 0 || gs[0] * gs[1] > 0) return;
  const bool alike = fs[0] == 0 && fs[1] == 0;
  const std::size_t axis = axis_of_line(*facet_.polygon.support, *f.form);
  const auto touch = [&](Line& line, std::uint32_t p) {
    if (p == line.at[0] || p == line.at[1]) return;
    const bool after = is_before(points[line.at[0]], points[p], axis, doubt_mm_),
               before = is_before(points[p], points[line.at[1]], axis, doubt_mm_);
    if (!alike || after == before) line.at.push_back(p);
  };
  if (fs[0] * fs[1] < 0 && gs[0] * gs[1] < 0) {
    const std::uint32_t p = add_point(Corner(facet_.polygon.support, f.form, g.form, doubt_mm_));
    f.at.push_back(p);
    g.at.push_back(p);
    return;
  }
  for (std::size_t end = 0; end < 2; ++end) {
    if (fs[end] == 0) touch(g, f.at[end]);
    if (gs[end] == 0) touch(f, g.at[end]);
  }
}

Label FacetNet::label(const Corner& p, bool positive) const {
  const Owner& owner = positive ? facet_.positive : facet_.negative;
  if (facet_.curve != nullptr) return positive ? facet_.curve->positive : facet_.curve->negative;
  const Eigen::Vector3d normal = facet_.polygon.support->rough.head<3>().normalized();
  return space_.fronts[owner.front].footings[owner.cell->footing].label_at(p, positive ? normal : -normal, doubt_mm_);
}

bool FacetNet::is_plain() const {
  if (lines.size() > facet_.polygon.sides.size()) return false;
  const Corner middle = Corner::middle(facet_.polygon.corners);
  return label(middle, false) == label(middle, true);
}

std::vector<Label> FacetNet::labels(const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                    const std::vector<std::pair<std::array<std::uint32_t, 2>, unsigned>>& edges,
                                    bool positive) const {
  std::unordered_set<std::uint64_t> borders;
  for (const auto& [ends, of] : edges)
    if ((of & (positive ? 2u : 1u)) != 0) borders.insert({directed(ends[0], ends[1]), directed(ends[1], ends[0])});
  std::unordered_map<std::uint64_t, std::uint32_t> at_edge;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) at_edge[directed(triangles[t][i], triangles[t][(i + 1) % 3])] = t;
  std::vector<Label> found(triangles.size());
  std::vector<bool> known(triangles.size(), false);
  std::vector<std::uint32_t> fresh;
  for (std::uint32_t first = 0; first < triangles.size(); ++first) {
    if (known[first]) continue;
    const auto& corners = triangles[first];
    const Label of = label(Corner::middle({points[corners[0]], points[corners[1]], points[corners[2]]}), positive);
    known[first] = true;
    for (fresh.push_back(first); !fresh.empty();) {
      const std::uint32_t t = fresh.back();
      fresh.pop_back();
      found[t] = of;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint64_t back = directed(triangles[t][(i + 1) % 3], triangles[t][i]);
        const auto other = at_edge.find(back);
        if (borders.contains(back) || other == at_edge.end() || known[other->second]) continue;
        known[other->second] = true;
        fresh.push_back(other->second);
      }
    }
  }
  return found;
}

std::vector<NetTriangle> FacetNet::triangles() const {
  const Form& support = *facet_.polygon.support;
  Eigen::Index axis = 0;
  support.rough.head<3>().cwiseAbs().maxCoeff(&axis);
  std::size_t i = (static_cast<std::size_t>(axis) + 1) % 3, j = (static_cast<std::size_t>(axis) + 2) % 3;
  if (support.rough[axis] < 0) std::swap(i, j);
  std::vector<SheetPoint> flat;
  for (const Corner& p : points) {
    const Triple at = p.at();
    flat.push_back({Point(at[i], at[j]), {}});
  }
  std::map<std::array<std::uint32_t, 2>, unsigned> merged;
  for (std::uint32_t l = 0; l < lines.size(); ++l) {
    for (const std::uint32_t p : lines[l].at) flat[p].lines.push_back(l);
    for (std::size_t k = 0; k + 1 < lines[l].at.size(); ++k) {
      const auto [a, b] = std::minmax(lines[l].at[k], lines[l].at[k + 1]);
      merged[{a, b}] |= lines[l].borders;
    }
  }
  std::vector<std::array<std::uint32_t, 2>> ends;
  for (const auto& [edge, borders] : merged) ends.push_back(edge);
  const std::vector<std::pair<std::array<std::uint32_t, 2>, unsigned>> edges(merged.begin(), merged.end());
  const auto all = triangulate(flat, ends);
  const std::vector<Label> negative = labels(all, edges, false), positive = labels(all, edges, true);
  std::vector<NetTriangle> out;
  for (std::size_t t = 0; t < all.size(); ++t)
    if (negative[t] != positive[t]) out.push_back({all[t], positive[t], negative[t]});
  return out;
}

}  // namespace sonoloft::skeleton
