#pragma once
// Numbers that decide exactly: of CGAL its kernel alone, which is LGPL.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

namespace sonoloft::network {

using Kernel = CGAL::Epeck;
using Number = Kernel::FT;
using Point = Kernel::Point_2;         ///< in the image frame of a plane
using Triple = std::array<Number, 3>;  ///< a point or a direction of space

/// The same number without the way it came about: cheap to build on.
[[nodiscard]] inline Number settled(const Number& x) {
  return Number(x.exact());
}

/// To 12 digits.
[[nodiscard]] inline double rounded(const Number& x) {
  const auto& bounds = x.approx();
  const double low = bounds.inf(), high = bounds.sup();
  if (high - low <= 5e-13 * std::max(std::abs(low), std::abs(high))) return 0.5 * (low + high);
  return CGAL::to_double(x.exact());
}

[[nodiscard]] inline Eigen::Vector2d rounded(const Point& p) {
  return {rounded(p.x()), rounded(p.y())};
}

/// The double next to the exact value: the same however the number came about.
[[nodiscard]] inline Eigen::Vector3d canonical(const Triple& p) {
  return {CGAL::to_double(p[0].exact()), CGAL::to_double(p[1].exact()), CGAL::to_double(p[2].exact())};
}

[[nodiscard]] inline Number dot(const Triple& a, const Triple& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

[[nodiscard]] inline int sign_of(const Number& x) {
  return static_cast<int>(CGAL::sign(x));
}

/// +1 where c lies left of a -> b.
[[nodiscard]] inline int turn(const Point& a, const Point& b, const Point& c) {
  return static_cast<int>(CGAL::orientation(a, b, c));
}

[[nodiscard]] inline Number cross(const Point& a, const Point& b, const Point& c, const Point& d) {
  return (b.x() - a.x()) * (d.y() - c.y()) - (b.y() - a.y()) * (d.x() - c.x());
}

/// a + t (b - a)
[[nodiscard]] inline Point between(const Point& a, const Point& b, const Number& t) {
  return {a.x() + t * (b.x() - a.x()), a.y() + t * (b.y() - a.y())};
}

/// t with x = a + t (b - a). @pre x lies on the line of a and b, which differ
[[nodiscard]] inline Number place_between(const Point& a, const Point& b, const Point& x) {
  const Eigen::Vector2d way = (rounded(b) - rounded(a)).cwiseAbs();
  if (way.x() > way.y()) return (x.x() - a.x()) / (b.x() - a.x());
  return (x.y() - a.y()) / (b.y() - a.y());
}

}  // namespace sonoloft::network
