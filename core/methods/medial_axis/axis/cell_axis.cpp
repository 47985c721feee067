#include "core/methods/medial_axis/axis/cell_axis.h"

#include <algorithm>
#include <cassert>
#include <map>

namespace sonoloft::medial {
namespace {

class AxisBuilder {
 public:
  AxisBuilder(const PlaneSet& planes, CellAxis& axis, double scale_mm)
      : planes_(planes), axis_(axis), scale_mm_(scale_mm) {}

  void build() {
    find_partings();
    const auto count = static_cast<std::uint32_t>(axis_.faces.size());
    for (std::uint32_t f = 0; f + 1 < count; ++f) {
      const ConvexPolygon face = outline_of(f);
      for (std::uint32_t g = f + 1; g < count; ++g) add_sheet(f, g, face);
    }
    add_ridges();
  }

 private:
  /// How far face g is above image points of face f.
  Eigen::Vector3d rough_above(std::uint32_t f, std::uint32_t g) const {
    const Trace& t = trace(f, g);
    return axis_.faces[g].side * Eigen::Vector3d(t.fa, t.fb, t.fc);
  }
  HalfPlane above(std::uint32_t f, std::uint32_t g) const {
    const Trace& t = trace(f, g);
    const int side = axis_.faces[g].side;
    return {side * t.a, side * t.b, side * t.c, g};
  }

  /// How fast the distances from f and g approach each other on the way up from f: 1 - cos of the angle between
  /// normals.
  struct Parting {
    Number exact;
    double rough;
  };
  void find_partings() {
    for (const Facing& f : axis_.faces)
      for (const Facing& g : axis_.faces) {
        const Number parting =
            settled(planes_.normals(f.plane, f.plane) - f.side * g.side * planes_.normals(f.plane, g.plane));
        partings_.push_back({parting, rounded(parting)});
      }
  }
  const Parting& parting(std::uint32_t f, std::uint32_t g) const { return partings_[f * axis_.faces.size() + g]; }

  ConvexPolygon outline_of(std::uint32_t f) const {
    ConvexPolygon polygon = ConvexPolygon::square(8 * scale_mm_);
    for (std::uint32_t g = 0; g < axis_.faces.size(); ++g)
      if (g != f) polygon.clip(rough_above(f, g), planes_.doubt_mm(), {kNoFace, g}, [&] { return above(f, g); });
    return polygon;
  }

  /// Where the roof over f is rather that of g than that of h: the lower one.
  HalfPlane lower(std::uint32_t f, std::uint32_t g, std::uint32_t h) const {
    const HalfPlane over_g = above(f, g), over_h = above(f, h);
    const Number &part_g = parting(f, g).exact, &part_h = parting(f, h).exact;
    return {over_h.a * part_g - over_g.a * part_h, over_h.b * part_g - over_g.b * part_h,
            over_h.c * part_g - over_g.c * part_h, h};
  }
  Eigen::Vector3d rough_lower(std::uint32_t f, std::uint32_t g, std::uint32_t h) const {
    return rough_above(f, h) * parting(f, g).rough - rough_above(f, g) * parting(f, h).rough;
  }

  void add_sheet(std::uint32_t f, std::uint32_t g, ConvexPolygon polygon) {
    for (std::uint32_t h = 0; h < axis_.faces.size() && !polygon.corners.empty(); ++h)
      if (h != f && h != g)
        polygon.clip(rough_lower(f, g, h), planes_.doubt_mm(), {g, h}, [&] { return lower(f, g, h); });
    if (polygon.corners.empty()) return;
    Sheet sheet{f, g, parting(f, g).rough, {}, {}, axis_.faces[f].side == axis_.faces[g].side};
    for (const ConvexPolygon::Corner& corner : polygon.corners)
      sheet.outline.push_back(
          vertex(f, g, {polygon.borders[corner.before].face, polygon.borders[corner.after].face}, corner));
    axis_.sheets.push_back(std::move(sheet));
  }

  /// The vertex over a point of f where the roof is that of g.
  std::uint32_t vertex(std::uint32_t f, std::uint32_t g, const std::array<std::uint32_t, 2>& beside,
                       const ConvexPolygon::Corner& corner) {
    const Point& p = corner.at;
    const auto above_mm = [&](std::uint32_t k) { return axis_.faces[k].side * trace(f, k).at(p); };
    std::vector<std::uint32_t> nearest{f, g};
    for (std::uint32_t k = 0; k < axis_.faces.size(); ++k) {
      if (k == f || k == g) continue;
      const double rough = rough_lower(f, g, k).dot(corner.rounded.homogeneous());
      if (std::abs(rough) > planes_.doubt_mm()) continue;
      if (k == beside[0] || k == beside[1] || above_mm(k) * parting(f, g).exact == above_mm(g) * parting(f, k).exact)
        nearest.push_back(k);
    }
    std::ranges::sort(nearest);
    const auto [place, is_new] = names_.try_emplace(nearest, static_cast<std::uint32_t>(axis_.vertices.size()));
    const bool is_corner = beside[0] == g || beside[1] == g;
    if (is_new)
      add_vertex(std::move(nearest), f, p, is_corner ? Number(0) : above_mm(g) / parting(f, g).exact, is_corner);
    return place->second;
  }
  void add_vertex(std::vector<std::uint32_t> nearest, std::uint32_t f, const Point& p, const Number& height_mm,
                  bool is_corner) {
    const Facing& face = axis_.faces[f];
    Triple at = planes_.point(face.plane, p);
    for (std::size_t i = 0; i < 3; ++i) at[i] += face.side * height_mm * planes_[face.plane].normal[i];
    AxisVertex vertex{std::move(nearest), {}, at, {rounded(at[0]), rounded(at[1]), rounded(at[2])}, is_corner};
    for (const std::uint32_t k : vertex.faces) vertex.feet.push_back(planes_.foot(axis_.faces[k].plane, at));
    axis_.vertices.push_back(std::move(vertex));
  }

  void add_ridges() {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> names;
    axis_.roofs.resize(axis_.faces.size());
    for (std::uint32_t s = 0; s < axis_.sheets.size(); ++s) {
      Sheet& sheet = axis_.sheets[s];
      axis_.roofs[sheet.f].push_back(s);
      axis_.roofs[sheet.g].push_back(s);
      for (std::size_t i = 0; i < sheet.outline.size(); ++i) {
        const auto [p, q] = std::minmax(sheet.outline[i], sheet.outline[(i + 1) % sheet.outline.size()]);
        const auto [name, is_new] = names.try_emplace({p, q}, static_cast<std::uint32_t>(axis_.ridges.size()));
        if (is_new) axis_.ridges.push_back({p, q, {}, axis_.vertices[p].corner && axis_.vertices[q].corner});
        axis_.ridges[name->second].sheets.push_back(s);
        sheet.sides.push_back(name->second);
      }
    }
  }

  const Trace& trace(std::uint32_t f, std::uint32_t g) const {
    return planes_.trace(axis_.faces[f].plane, axis_.faces[g].plane);
  }

  const PlaneSet& planes_;
  CellAxis& axis_;
  double scale_mm_;
  std::vector<Parting> partings_;  ///< [#faces^2]
  std::map<std::vector<std::uint32_t>, std::uint32_t> names_;
};

}  // namespace

const Point& AxisVertex::foot(std::uint32_t face) const {
  const auto found = std::ranges::lower_bound(faces, face);
  assert(found != faces.end() && *found == face);
  return feet[static_cast<std::size_t>(found - faces.begin())];
}

CellAxis::CellAxis(const PlaneSet& planes, std::span<const Facing> of, double scale_mm) : faces(of.begin(), of.end()) {
  AxisBuilder(planes, *this, scale_mm).build();
}

Eigen::Vector3d above(const PlaneSet& planes, const CellAxis& axis, const Sheet& sheet, const Eigen::Vector2d& p) {
  const Facing &f = axis.faces[sheet.f], &g = axis.faces[sheet.g];
  const double height_mm = g.side * planes.trace(f.plane, g.plane).approx(p) / sheet.parting;
  return planes[f.plane].frame * Eigen::Vector3d(p.x(), p.y(), f.side * height_mm);
}

}  // namespace sonoloft::medial
