#include "core/methods/medial_axis/axis/convex_clip.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace sonoloft::medial {
namespace {

Point meet(const HalfPlane& g, const HalfPlane& h) {
  const Number determinant = g.a * h.b - h.a * g.b;
  return {(g.b * h.c - h.b * g.c) / determinant, (g.c * h.a - h.c * g.a) / determinant};
}

}  // namespace

ConvexPolygon ConvexPolygon::square(double reach_mm) {
  const double r = reach_mm;
  ConvexPolygon polygon;
  const Eigen::Vector2d at[4] = {{-r, -r}, {r, -r}, {r, r}, {-r, r}};
  for (std::uint32_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d way = at[(i + 1) % 4] - at[i], inward(-way.y() / (2 * r), way.x() / (2 * r));
    polygon.corners.push_back({Point(at[i].x(), at[i].y()), at[i], (i + 3) % 4, i});
    polygon.borders.push_back({inward.x(), inward.y(), r, kNoFace});
  }
  return polygon;
}

ConvexPolygon::Sides ConvexPolygon::rough_sides(const Eigen::Vector3d& h, double doubt_mm) {
  sides_.clear();
  bool unsure = false, inside = false, outside = false;
  for (const Corner& corner : corners) {
    const double at = h.dot(corner.rounded.homogeneous());
    sides_.push_back(at > doubt_mm ? 1 : at < -doubt_mm ? -1 : 0);
    (sides_.back() == 0 ? unsure : sides_.back() > 0 ? inside : outside) = true;
  }
  if (unsure) return Sides::unsure;
  return !outside ? Sides::keep_all : inside ? Sides::cut : Sides::keep_none;
}

bool ConvexPolygon::is_between(const Corner& corner, const std::array<std::uint32_t, 2>& faces) const {
  const std::array found{borders[corner.before].face, borders[corner.after].face};
  return found == faces || found == std::array{faces[1], faces[0]};
}

void ConvexPolygon::cut(const HalfPlane& h, const std::array<std::uint32_t, 2>& through) {
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (sides_[i] == 0 && !is_between(corners[i], through))
      sides_[i] = sign_of(h.a * corners[i].at.x() + h.b * corners[i].at.y() + h.c);
  if (std::ranges::count(sides_, -1) == 0) return;
  if (std::ranges::count(sides_, 1) == 0) return corners.clear();
  std::vector<Corner> kept;
  const auto border = static_cast<std::uint32_t>(borders.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Corner& corner = corners[i];
    const int here = sides_[i], next = sides_[(i + 1) % corners.size()];
    const int last = sides_[(i + corners.size() - 1) % corners.size()];
    if (here >= 0) {
      kept.push_back(corner);
      if (here == 0 && next < 0) kept.back().after = border;
      if (here == 0 && last < 0) kept.back().before = border;
    }
    if (here * next >= 0) continue;
    const Point at = meet(borders[corner.after], h);
    if (here > 0)
      kept.push_back({at, rounded(at), corner.after, border});
    else
      kept.push_back({at, rounded(at), border, corner.after});
  }
  borders.push_back(h);
  corners = std::move(kept);
}

}  // namespace sonoloft::medial
