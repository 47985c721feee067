#include "core/methods/medial_axis/axis/cell_curves.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <map>

#include "core/methods/medial_axis/axis/roof_side.h"

namespace sonoloft::medial {
namespace {

class Projector {
 public:
  Projector(const CurveNetwork& network, const CellAxis& axis) : network_(network), axis_(axis) {
    for (const AxisVertex& v : axis.vertices) out_.vertices.push_back({.position = v.position, .on_cell = v.corner});
    out_.on_ridges.resize(axis.ridges.size());
    add_points_at_edges();
  }

  CellCurves curves(std::span<const FaceCurve> edges) {
    for (auto first = edges.begin(); first != edges.end();) {
      const std::uint32_t face = first->face;
      const std::vector<RoofSide> sides = roof_sides(axis_, face, network_.planes.doubt_mm());
      for (; first != edges.end() && first->face == face; ++first) add_curve(*first, sides);
    }
    unify_on_ridges();
    for (std::size_t i = 0; i < out_.curves.size(); ++i) finish(out_.curves[i], along_[i]);
    return std::move(out_);
  }

 private:
  /// Points of contours that end at the edges of the cell: both of its faces there have them.
  void add_points_at_edges() {
    for (std::uint32_t r = 0; r < axis_.ridges.size(); ++r) {
      if (!axis_.ridges[r].edge) continue;
      const Sheet& sheet = axis_.sheets[axis_.ridges[r].sheets.front()];
      add_points_at(r, sheet.f, sheet.g);
      add_points_at(r, sheet.g, sheet.f);
    }
  }
  void add_points_at(std::uint32_t r, std::uint32_t face, std::uint32_t other) {
    const auto found = network_.on_lines.find({axis_.faces[face].plane, axis_.faces[other].plane});
    if (found == network_.on_lines.end()) return;
    const Ridge& ridge = axis_.ridges[r];
    const RoofSide side = roof_side(axis_, r, face, network_.planes.doubt_mm());
    for (const std::uint32_t point : found->second) {
      if (!side.box.contains(network_.points[point].rounded)) continue;
      const Number t = place_between(side.p, side.q, network_.points[point].at);
      if (t < 0 || t > 1) continue;
      const std::uint32_t v = add_on_ridge(r, t);
      contour_vertices_[point] = v;
      if (v == ridge.p || v == ridge.q) continue;
      out_.vertices[v].position = network_.points[point].position;
      out_.vertices[v].point = point;
    }
  }

  std::uint32_t add_on_ridge(std::uint32_t r, const Number& t) {
    const Ridge& ridge = axis_.ridges[r];
    if (t == 0) return ridge.p;
    if (t == 1) return ridge.q;
    const auto v = static_cast<std::uint32_t>(out_.vertices.size());
    const Eigen::Vector3d p = axis_.vertices[ridge.p].position, q = axis_.vertices[ridge.q].position;
    out_.vertices.push_back({.position = p + rounded(t) * (q - p), .on_cell = ridge.edge, .ridge = r, .along = t});
    out_.on_ridges[r].push_back({t, v});
    return v;
  }
  bool is_on_axis(std::uint32_t v) const { return v < axis_.vertices.size() || out_.vertices[v].ridge != kNoPoint; }

  std::uint32_t contour_vertex(std::uint32_t point) {
    const auto [place, is_new] = contour_vertices_.try_emplace(point, static_cast<std::uint32_t>(out_.vertices.size()));
    if (is_new) out_.vertices.push_back({.position = network_.points[point].position, .on_cell = true, .point = point});
    return place->second;
  }
  std::uint32_t roof_vertex(std::uint32_t face, std::uint32_t point, std::span<const RoofSide> sides) {
    const std::uint32_t contour = contour_vertex(point);
    if (is_on_axis(contour)) return contour;
    const auto [place, is_new] = roof_vertices_.try_emplace(point, kNoPoint);
    if (!is_new) return place->second;
    const NetworkPoint& p = network_.points[point];
    for (const RoofSide& side : sides)
      if (side.box.contains(p.rounded) && turn(side.p, side.q, p.at) == 0) {
        const Number t = place_between(side.p, side.q, p.at);
        if (t >= 0 && t <= 1) return place->second = add_on_ridge(side.ridge, t);
      }
    place->second = static_cast<std::uint32_t>(out_.vertices.size());
    out_.vertices.push_back({.position = above(face, p), .point = point, .face = face});
    return place->second;
  }
  /// Where the foot of the roof over a face is a given point: the lowest of all sheets.
  Eigen::Vector3d above(std::uint32_t face, const NetworkPoint& p) const {
    double height_mm = std::numeric_limits<double>::infinity();
    for (const std::uint32_t s : axis_.roofs[face]) {
      const Sheet& sheet = axis_.sheets[s];
      const Facing& other = axis_.faces[sheet.f == face ? sheet.g : sheet.f];
      const double distance_mm = other.side * network_.planes.trace(p.plane, other.plane).approx(p.rounded);
      height_mm = std::min(height_mm, distance_mm / sheet.parting);
    }
    return p.position + axis_.faces[face].side * height_mm * network_.planes[p.plane].frame.linear().col(2);
  }

  void add_curve(const FaceCurve& of, std::span<const RoofSide> sides) {
    const NetworkEdge& edge = network_.edges[of.edge];
    Curve curve{of.face, of.edge, contour_vertex(edge.a), contour_vertex(edge.b), {}, {}};
    curve.roof.push_back({Number(0), roof_vertex(of.face, edge.a, sides)});
    curve.roof.push_back({Number(1), roof_vertex(of.face, edge.b, sides)});
    along_.emplace_back();
    for (const RoofSide& side : sides) cross(curve, side);
    out_.curves.push_back(std::move(curve));
  }
  void cross(Curve& curve, const RoofSide& side) {
    const NetworkEdge& edge = network_.edges[curve.edge];
    const NetworkPoint &a = network_.points[edge.a], &b = network_.points[edge.b];
    Eigen::AlignedBox2d box(a.rounded);
    if (!box.extend(b.rounded).intersects(side.box)) return;
    const int at_a = turn(side.p, side.q, a.at), at_b = turn(side.p, side.q, b.at);
    if (at_a == 0 && at_b == 0) along_.back().push_back(side.ridge);
    if (at_a * at_b >= 0) return;
    const int at_p = turn(a.at, b.at, side.p), at_q = turn(a.at, b.at, side.q);
    if (at_p * at_q > 0) return;
    const Number s = medial::cross(a.at, side.p, side.p, side.q) / medial::cross(a.at, b.at, side.p, side.q);
    const Number t = at_p == 0   ? Number(0)
                     : at_q == 0 ? Number(1)
                                 : medial::cross(side.p, a.at, a.at, b.at) / medial::cross(side.p, side.q, a.at, b.at);
    curve.roof.push_back({s, add_on_ridge(side.ridge, t)});
  }

  /// Points of different curves at one place of a ridge become one.
  void unify_on_ridges() {
    same_.resize(out_.vertices.size());
    for (std::uint32_t v = 0; v < same_.size(); ++v) same_[v] = v;
    for (std::vector<Waypoint>& points : out_.on_ridges) {
      std::ranges::sort(points, [](const Waypoint& a, const Waypoint& b) { return a.along < b.along; });
      std::size_t kept = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (kept > 0 && points[kept - 1].along == points[i].along)
          same_[points[i].vertex] = points[kept - 1].vertex;
        else
          points[kept++] = points[i];
      }
      points.resize(kept);
    }
  }

  void finish(Curve& curve, std::span<const std::uint32_t> along_ridges) {
    curve.a = same_[curve.a];
    curve.b = same_[curve.b];
    for (Waypoint& w : curve.roof) w.vertex = same_[w.vertex];
    for (const std::uint32_t r : along_ridges) {
      add_waypoint(curve, axis_.ridges[r].p);
      add_waypoint(curve, axis_.ridges[r].q);
      for (const Waypoint& w : out_.on_ridges[r]) add_waypoint(curve, w.vertex);
    }
    std::ranges::sort(curve.roof, [](const Waypoint& a, const Waypoint& b) { return a.along < b.along; });
    const auto is_same = [](const Waypoint& a, const Waypoint& b) { return a.vertex == b.vertex; };
    curve.roof.erase(std::unique(curve.roof.begin(), curve.roof.end(), is_same), curve.roof.end());
    for (std::size_t i = 0; i + 1 < curve.roof.size(); ++i)
      curve.over.push_back(sheet_over(curve, (curve.roof[i].along + curve.roof[i + 1].along) / 2));
  }
  void add_waypoint(Curve& curve, std::uint32_t v) {
    const NetworkEdge& edge = network_.edges[curve.edge];
    const Number t = place_between(network_.points[edge.a].at, network_.points[edge.b].at,
                                   foot(network_, axis_, v, out_.vertices[v], curve.face));
    if (t > 0 && t < 1) curve.roof.push_back({t, v});
  }

  /// The sheet above a place of a curve; kNoPoint above a ridge.
  std::uint32_t sheet_over(const Curve& curve, const Number& t) const {
    const NetworkEdge& edge = network_.edges[curve.edge];
    const Point p = between(network_.points[edge.a].at, network_.points[edge.b].at, t);
    for (const std::uint32_t s : axis_.roofs[curve.face])
      if (is_over(axis_.sheets[s], curve.face, p)) return s;
    return kNoPoint;
  }
  bool is_over(const Sheet& sheet, std::uint32_t face, const Point& p) const {
    const int turning = face == sheet.g && sheet.flipped ? -1 : 1;
    for (std::size_t i = 0; i < sheet.outline.size(); ++i) {
      const Point& a = axis_.vertices[sheet.outline[i]].foot(face);
      const Point& b = axis_.vertices[sheet.outline[(i + 1) % sheet.outline.size()]].foot(face);
      if (turn(a, b, p) * turning <= 0) return false;
    }
    return true;
  }

  const CurveNetwork& network_;
  const CellAxis& axis_;
  CellCurves out_;
  std::map<std::uint32_t, std::uint32_t> contour_vertices_, roof_vertices_;  ///< [point]
  std::vector<std::vector<std::uint32_t>> along_;                            ///< [#curves] ridges on whose line it lies
  std::vector<std::uint32_t> same_;
};

}  // namespace

CellCurves project_curves(const CurveNetwork& network, const CellAxis& axis, std::span<const FaceCurve> edges) {
  return Projector(network, axis).curves(edges);
}

Point foot(const CurveNetwork& network, const CellAxis& axis, std::uint32_t id, const CurveVertex& vertex,
           std::uint32_t face) {
  if (id < axis.vertices.size()) return axis.vertices[id].foot(face);
  if (vertex.ridge == kNoPoint) {
    assert(vertex.face == face);
    return network.points[vertex.point].at;
  }
  const Ridge& ridge = axis.ridges[vertex.ridge];
  return between(axis.vertices[ridge.p].foot(face), axis.vertices[ridge.q].foot(face), vertex.along);
}

}  // namespace sonoloft::medial
