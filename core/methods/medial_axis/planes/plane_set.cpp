#include "core/methods/medial_axis/planes/plane_set.h"

namespace sonoloft::medial {
namespace {

Triple exactly(const Eigen::Vector3d& v) {
  return {Number(v.x()), Number(v.y()), Number(v.z())};
}

Triple settled_all(const Triple& v) {
  return {settled(v[0]), settled(v[1]), settled(v[2])};
}

/// v + t n
Triple moved(const Triple& v, const Number& t, const Triple& n) {
  return {v[0] + t * n[0], v[1] + t * n[1], v[2] + t * n[2]};
}

ExactPlane plane_of(const Eigen::Isometry3d& frame) {
  const Eigen::Vector3d n = frame.linear().col(2), o = frame.translation();
  ExactPlane plane;
  plane.frame = frame;
  plane.normal = exactly(n);
  plane.offset = Number(-n.dot(o));
  const Number square = dot(plane.normal, plane.normal);
  const auto into_plane = [&](const Eigen::Vector3d& v, const Number& offset) {
    const Triple exact = exactly(v);
    return settled_all(moved(exact, -(dot(exact, plane.normal) + offset) / square, plane.normal));
  };
  plane.origin = into_plane(o, plane.offset);
  plane.x = into_plane(frame.linear().col(0), Number(0));
  plane.y = into_plane(frame.linear().col(1), Number(0));
  const Number xx = dot(plane.x, plane.x), xy = dot(plane.x, plane.y), yy = dot(plane.y, plane.y);
  const Number determinant = xx * yy - xy * xy;
  for (std::size_t i = 0; i < 3; ++i) {
    plane.dual_x[i] = settled((yy * plane.x[i] - xy * plane.y[i]) / determinant);
    plane.dual_y[i] = settled((xx * plane.y[i] - xy * plane.x[i]) / determinant);
  }
  return plane;
}

Trace trace_of(const ExactPlane& on, const ExactPlane& of) {
  const Number a = settled(dot(on.x, of.normal)), b = settled(dot(on.y, of.normal)),
               c = settled(dot(on.origin, of.normal) + of.offset);
  return {a, b, c, rounded(a), rounded(b), rounded(c)};
}

}  // namespace

PlaneSet::PlaneSet(std::span<const Eigen::Isometry3d> frames, double scale_mm) : doubt_mm_(1e-11 * scale_mm) {
  for (const Eigen::Isometry3d& frame : frames) planes_.push_back(plane_of(frame));
  for (const ExactPlane& on : planes_)
    for (const ExactPlane& of : planes_) {
      traces_.push_back(trace_of(on, of));
      normals_.push_back(settled(dot(on.normal, of.normal)));
    }
}

int PlaneSet::side(std::size_t on, std::size_t of, const Point& p, const Eigen::Vector2d& rounded) const {
  const Trace& t = trace(on, of);
  const double distance_mm = t.approx(rounded);
  if (distance_mm > doubt_mm_) return 1;
  if (distance_mm < -doubt_mm_) return -1;
  return sign_of(t.at(p));
}

Triple PlaneSet::point(std::size_t plane, const Point& p) const {
  const ExactPlane& f = planes_[plane];
  return moved(moved(f.origin, p.x(), f.x), p.y(), f.y);
}

Point PlaneSet::foot(std::size_t plane, const Triple& p) const {
  const ExactPlane& f = planes_[plane];
  const Triple r{p[0] - f.origin[0], p[1] - f.origin[1], p[2] - f.origin[2]};
  return {dot(f.dual_x, r), dot(f.dual_y, r)};
}

}  // namespace sonoloft::medial
