#include "core/methods/medial_axis/curve_network.h"

#include <algorithm>

namespace sonoloft::medial {
namespace {

/// Where a plane crosses an edge: `t` of the way.
struct Crossing {
  Number t;
  std::uint32_t plane;
};

}  // namespace

CurveNetwork::CurveNetwork(const PlaneSet& all, std::span<const Section* const> of)
    : planes(all), sections(of.begin(), of.end()) {
  for (std::uint32_t f = 0; f < sections.size(); ++f) {
    if (sections[f] == nullptr) continue;
    const auto first = static_cast<std::uint32_t>(points.size());
    for (const Eigen::Vector2d& p : sections[f]->points) {
      const Point at(p.x(), p.y());
      NetworkPoint point{f, at, p, planes[f].frame * Eigen::Vector3d(p.x(), p.y(), 0), {}};
      for (std::uint32_t g = 0; g < planes.size(); ++g)
        if (g != f && planes.side(f, g, at, p) == 0) point.on.push_back(g);
      points.push_back(std::move(point));
    }
    for (const SectionEdge& edge : sections[f]->edges) add_edge(f, edge, first);
  }
  for (std::uint32_t p = 0; p < points.size(); ++p) {
    if (!points[p].on.empty()) points[p].position = canonical(planes.point(points[p].plane, points[p].at));
    for (const std::uint32_t g : points[p].on) on_lines[{points[p].plane, g}].push_back(p);
  }
}

void CurveNetwork::add_edge(std::uint32_t f, const SectionEdge& edge, std::uint32_t first_point) {
  const std::uint32_t a = first_point + edge.a, b = first_point + edge.b;
  std::vector<Crossing> crossings;
  for (std::uint32_t g = 0; g < planes.size(); ++g) {
    if (g == f || side(a, g) * side(b, g) >= 0) continue;
    const Trace& trace = planes.trace(f, g);
    const Number da = trace.at(points[a].at), db = trace.at(points[b].at);
    crossings.push_back({da / (da - db), g});
  }
  std::ranges::sort(crossings, [](const Crossing& p, const Crossing& q) { return p.t < q.t; });
  std::uint32_t last = a;
  for (std::size_t i = 0; i < crossings.size();) {
    const Point at = between(points[a].at, points[b].at, crossings[i].t);
    NetworkPoint point{f, {settled(at.x()), settled(at.y())}, rounded(at), {}, {}};
    for (const Number t = crossings[i].t; i < crossings.size() && crossings[i].t == t; ++i)
      point.on.push_back(crossings[i].plane);
    std::ranges::sort(point.on);
    const auto next = static_cast<std::uint32_t>(points.size());
    points.push_back(std::move(point));
    edges.push_back({f, last, next, edge.left, edge.right});
    last = next;
  }
  edges.push_back({f, last, b, edge.left, edge.right});
}

int CurveNetwork::side(std::uint32_t point, std::uint32_t of) const {
  const NetworkPoint& p = points[point];
  return std::ranges::binary_search(p.on, of) ? 0 : planes.side(p.plane, of, p.at, p.rounded);
}

int CurveNetwork::edge_side(const NetworkEdge& edge, std::uint32_t of) const {
  const int a = side(edge.a, of);
  return a != 0 ? a : side(edge.b, of);
}

Label CurveNetwork::label_at(std::uint32_t plane, const Point& p, const Eigen::Vector2d& near) const {
  const Section* section = sections[plane];
  if (section == nullptr) return kOutside;
  int label = section->border;
  const auto is_before = [&](const Eigen::Vector2d& q) {  // q.x <= p.x
    const double by_mm = near.x() - q.x();
    return std::abs(by_mm) > planes.doubt_mm() ? by_mm > 0 : Number(q.x()) <= p.x();
  };
  for (const SectionEdge& edge : section->edges) {  // what is met on the way down to the point, in any order
    const Eigen::Vector2d &a = section->points[edge.a], &b = section->points[edge.b];
    if (near.y() > std::max(a.y(), b.y()) + planes.doubt_mm()) continue;
    const bool a_before = is_before(a);
    if (a_before == is_before(b)) continue;
    const int side = turn(Point(a.x(), a.y()), Point(b.x(), b.y()), p);
    if (a_before ? side < 0 : side > 0) label += (a_before ? 1 : -1) * (int{edge.right} - int{edge.left});
  }
  return static_cast<Label>(label);
}

}  // namespace sonoloft::medial
