#pragma once
#include <Eigen/Core>
#include <boost/math/quadrature/gauss_kronrod.hpp>

namespace sonoloft::test {

/// The integral of value(y) h / |y - x|^4 over the triangle (foot, a, b), signed by its orientation:
/// y = foot + s (a - foot + t (b - a)). Adaptive in both directions; nothing of the closed forms is used.
template <class Value>
double triangle_integral(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& foot, double height,
                         const Value& value) {
  using boost::math::quadrature::gauss_kronrod;
  const Eigen::Vector2d from = a - foot, e = b - a;
  const double twice_area = from.x() * e.y() - from.y() * e.x();
  const auto ray = [&](double t) {
    const Eigen::Vector2d end = from + t * e;
    const auto along = [&](double s) {
      const double distance2 = s * s * end.squaredNorm() + height * height;
      return value(Eigen::Vector2d(foot + s * end)) * height * s / (distance2 * distance2);
    };
    return gauss_kronrod<double, 21>::integrate(along, 0.0, 1.0, 15, 1e-11);
  };
  return twice_area * gauss_kronrod<double, 21>::integrate(ray, 0.0, 1.0, 15, 1e-11);
}

}  // namespace sonoloft::test
