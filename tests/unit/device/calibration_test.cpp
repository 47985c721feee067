#include "host/device/calibration.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>

#include "tests/support/wire/wire_slices.h"

using namespace sonoloft;
using device::make_calibration;

namespace {

protocol::CalibrationMessage message(const Eigen::Matrix<double, 3, 4>& m) {
  protocol::CalibrationMessage result{7, 0, {}};
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(result.image_to_probe) = m;
  return result;
}

Eigen::Matrix<double, 3, 4> turned(double sx, double sy, double sz) {
  Eigen::Isometry3d t(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 0.5).normalized()));
  t.translation() = Eigen::Vector3d(10, -20, 3);
  Eigen::Matrix<double, 3, 4> m = t.matrix().topRows<3>();
  m.col(0) *= sx;
  m.col(1) *= sy;
  m.col(2) *= sz;
  return m;
}

}  // namespace

TEST_CASE("calibration: pixel sizes go into the points, the rest is rigid, and together they are the matrix") {
  const auto m = turned(0.2, 0.31, 1);
  const auto calibration = make_calibration(message(m));
  REQUIRE(calibration);
  CHECK(calibration->pixel_size_mm.x() == doctest::Approx(0.2));
  CHECK(calibration->pixel_size_mm.y() == doctest::Approx(0.31));
  const Eigen::Matrix3d r = calibration->image_to_probe.linear();
  CHECK((r * r.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-14);
  CHECK(r.determinant() == doctest::Approx(1));
  const Eigen::Vector3d by_matrix = m * Eigen::Vector4d(320, 240, 0, 1);
  const Eigen::Vector3d by_parts = calibration->image_to_probe * Eigen::Vector3d(320 * 0.2, 240 * 0.31, 0);
  CHECK((by_matrix - by_parts).norm() < 1e-12);
}

TEST_CASE("calibration: the third column says nothing about a plane, even of a left-handed matrix") {
  const auto right = make_calibration(message(turned(0.2, 0.2, 1)));
  const auto left = make_calibration(message(turned(0.2, 0.2, -3)));
  REQUIRE((right && left));
  CHECK(right->image_to_probe.matrix() == left->image_to_probe.matrix());
}

TEST_CASE("calibration: a little skew is made square, keeping x; more is refused") {
  auto m = turned(0.2, 0.2, 1);
  const Eigen::Vector3d x = m.col(0);
  m.col(1) += 0.0009 * x;
  const auto calibration = make_calibration(message(m));
  REQUIRE(calibration);
  CHECK((calibration->image_to_probe.linear().col(0) - x.normalized()).norm() < 1e-12);
  m.col(1) += 0.01 * x;
  const auto skewed = make_calibration(message(m));
  REQUIRE_FALSE(skewed);
  CHECK(skewed.error().code == ErrorCode::not_rigid);
  CHECK(skewed.error().message.find("89.") != std::string::npos);
}

TEST_CASE("calibration: none, no pixels and no numbers are refused with their own code") {
  auto none = message(turned(1, 1, 1));
  none.id = 0;
  CHECK(make_calibration(none).error().code == ErrorCode::not_available);
  CHECK(make_calibration(message(turned(0, 0.2, 1))).error().code == ErrorCode::not_rigid);
  CHECK(make_calibration(message(turned(0.2, 0, 1))).error().code == ErrorCode::not_rigid);
  CHECK(make_calibration(message(turned(1e300, 1e300, 1))).error().code == ErrorCode::not_rigid);
  auto bad = message(turned(1, 1, 1));
  bad.image_to_probe[11] = std::numeric_limits<double>::quiet_NaN();
  CHECK(make_calibration(bad).error().code == ErrorCode::non_finite);
}

TEST_CASE("calibration: a quaternion that is a little long still gives a rigid pose") {
  auto owned = test::make_wire_slice(3);
  for (double* q : {&owned.slice.pose.qw, &owned.slice.pose.qx, &owned.slice.pose.qy, &owned.slice.pose.qz}) {
    *q *= 1.0009;
  }
  auto calibration = *make_calibration(message(turned(0.2, 0.2, 1)));
  const auto delivered = device::to_delivered(owned.view(), 3, calibration, {});
  const Eigen::Matrix3d r = delivered.slice.image_to_reference.linear();
  CHECK((r * r.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-14);
}

TEST_CASE("calibration: the worked example of docs/coordinates.md") {
  Eigen::Matrix<double, 3, 4> m;
  m << 0.2, 0, 0, -64, 0, 0.25, 0, -10, 0, 0, 1, 5;
  const auto calibration = make_calibration(message(m));
  REQUIRE(calibration);
  const std::array<protocol::Point, 3> points{{{320, 100}, {330, 100}, {330, 110}}};
  const protocol::Contour contour{0, 3, 1, 0};
  protocol::Slice sent;
  sent.calibration_id = 7;
  sent.pose.qw = sent.pose.qz = std::sqrt(0.5);
  sent.pose.tx_mm = 100;
  sent.pose.ty_mm = 20;
  sent.pose.tz_mm = -30;
  sent.points = points;
  sent.contours = {&contour, 1};
  const TrackedSlice slice = device::to_delivered(sent, 0, *calibration, {}).slice;
  CHECK((slice.points[0] - Eigen::Vector2d(64, 25)).norm() < 1e-12);
  const Eigen::Vector3d p_reference = slice.image_to_reference * Eigen::Vector3d(64, 25, 0);
  CHECK((p_reference - Eigen::Vector3d(85, 20, -25)).norm() < 1e-12);
}
