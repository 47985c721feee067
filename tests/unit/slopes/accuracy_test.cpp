#include <doctest/doctest.h>

#include <random>

#include "core/slopes/contour_slopes.h"
#include "tests/support/planes.h"
#include "tests/support/slopes/ellipsoid.h"
#include "tests/support/slopes/sloped_slices.h"

namespace sonoloft {
namespace {

TEST_CASE("slopes: of an ellipsoid cut by random planes they are right within a few degrees") {
  const test::Ellipsoid body{{50, 35, 25}};
  const auto mean_error = [&](int planes) {
    std::mt19937 rng(1);
    test::SlopedSlices s(1.7);
    for (int i = 0; i < planes; ++i) s.add(body.cut(test::random_frame(rng, 20), 300));
    (void)s.slopes.update(s.cells, 1);
    double error = 0, angle = 0, count = 0;
    for (const SliceId slice : s.cells.slices()) {
      const Section& section = s.cells.section(slice);
      for (std::size_t i = 0; i < section.points.size(); ++i) {
        const Eigen::Vector3d at =
            section.image_to_reference * Eigen::Vector3d(section.points[i].x(), section.points[i].y(), 0);
        const double slope = test::slope_of(body.normal(at), section.image_to_reference.linear().col(2));
        const double true_angle = std::atan(std::clamp(slope, -2.0, 2.0));
        error += std::abs(std::atan(double{s.slopes.bends(slice)[i].slope}) - true_angle);
        angle += std::abs(true_angle);
        ++count;
      }
    }
    constexpr double kDegree = std::numbers::pi / 180;
    MESSAGE(planes, " planes: slopes off by ", error / count / kDegree, " degrees; without any, by ",
            angle / count / kDegree);
    return error / count / kDegree;
  };
  CHECK(mean_error(10) < 2.5);
  CHECK(mean_error(20) < 1.2);
  CHECK(mean_error(40) < 0.8);
}

}  // namespace
}  // namespace sonoloft
