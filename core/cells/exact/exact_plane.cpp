#include "core/cells/exact/exact_plane.h"

#include <CGAL/Exact_rational.h>
#include <CGAL/determinant.h>
#include <CGAL/number_utils.h>

#include <Eigen/Geometry>
#include <cassert>
#include <cmath>
#include <limits>

namespace sonoloft {
namespace {

using Exact = CGAL::Exact_rational;
constexpr double kUlp = std::numeric_limits<double>::epsilon();

struct ExactPlane {
  explicit ExactPlane(const Plane& p) : x(p.normal.x()), y(p.normal.y()), z(p.normal.z()), w(p.offset) {}
  Exact x, y, z, w;
};

Exact det3(const Exact& a, const Exact& b, const Exact& c, const Exact& d, const Exact& e, const Exact& f,
           const Exact& g, const Exact& h, const Exact& i) {
  return CGAL::determinant(a, b, c, d, e, f, g, h, i);
}

Eigen::Vector3d meet_exactly(const ExactPlane& a, const ExactPlane& b, const ExactPlane& c) {
  const Exact d = det3(a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z);
  assert(!CGAL::is_zero(d));
  const Exact x = det3(-a.w, a.y, a.z, -b.w, b.y, b.z, -c.w, c.y, c.z) / d;
  const Exact y = det3(a.x, -a.w, a.z, b.x, -b.w, b.z, c.x, -c.w, c.z) / d;
  const Exact z = det3(a.x, a.y, -a.w, b.x, b.y, -b.w, c.x, c.y, -c.w) / d;
  return {CGAL::to_double(x), CGAL::to_double(y), CGAL::to_double(z)};
}

}  // namespace

Eigen::Vector3d meet(const Plane& a, const Plane& b, const Plane& c, double scale) {
  using Wide = Eigen::Matrix<long double, 3, 1>;
  const Wide na = a.normal.cast<long double>();
  const Wide nb = b.normal.cast<long double>();
  const Wide nc = c.normal.cast<long double>();
  const Wide bc = nb.cross(nc);
  const long double d = na.dot(bc);
  // Cramer's rule: its numerators are sums of terms of at most the offsets, so a small determinant magnifies their
  // rounding. 11 bits more than a double make up for all but extreme cases.
  const double offset = std::abs(a.offset) + std::abs(b.offset) + std::abs(c.offset);
  if (std::abs(static_cast<double>(d)) * scale > 2e-3 * (offset + scale))
    return ((-bc * a.offset - nc.cross(na) * b.offset - na.cross(nb) * c.offset) / d).cast<double>();
  return meet_exactly(ExactPlane(a), ExactPlane(b), ExactPlane(c));
}

int side_of_plane(const Plane& a, const Plane& b, const Plane& c, const Eigen::Vector3d& approx, double scale,
                  const Plane& plane) {
  const double s = plane.distance(approx);
  // meet() errs by a few roundings of the scale, the distance by a few more; the rest is margin.
  const double bound = 256.0 * kUlp * (scale + std::abs(plane.offset));
  if (s > bound) return 1;
  if (s < -bound) return -1;
  const ExactPlane ea(a), eb(b), ec(c), ep(plane);
  const Exact d3 = det3(ea.x, ea.y, ea.z, eb.x, eb.y, eb.z, ec.x, ec.y, ec.z);
  const Exact d4 =
      CGAL::determinant(ea.x, ea.y, ea.z, ea.w, eb.x, eb.y, eb.z, eb.w, ec.x, ec.y, ec.z, ec.w, ep.x, ep.y, ep.z, ep.w);
  return static_cast<int>(CGAL::sign(d4)) * static_cast<int>(CGAL::sign(d3));
}

}  // namespace sonoloft
