#include "host/device/calibration.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/slice/mask/label_mask.h"

namespace sonoloft::device {
namespace {

constexpr double kMinPixelMm = 1e-6;
constexpr double kMaxSkew = 1e-3;  // cosine between the axes: 0.06 degrees

std::vector<Eigen::Vector2d> to_mm(std::span<const protocol::Point> points, const Eigen::Vector2d& pixel_size_mm) {
  std::vector<Eigen::Vector2d> result;
  result.reserve(points.size());
  for (const protocol::Point& p : points) {
    result.emplace_back(double{p.x_px} * pixel_size_mm.x(), double{p.y_px} * pixel_size_mm.y());
  }
  return result;
}

void add_contours(const protocol::Slice& slice, const Eigen::Vector2d& pixel_size_mm, TrackedSlice& tracked) {
  tracked.points = to_mm(slice.points, pixel_size_mm);
  tracked.contours.reserve(slice.contours.size());
  for (const protocol::Contour& c : slice.contours) {
    tracked.contours.push_back({c.first, c.count, c.label, (c.flags & protocol::kHoleFlag) != 0});
  }
}

// Beyond its grid nothing was seen.
void add_mask(const protocol::Slice& slice, const Eigen::Vector2d& pixel_size_mm, TrackedSlice& tracked) {
  const protocol::MaskGrid& grid = slice.mask_grid;
  std::vector<Label> labels;
  labels.reserve(std::size_t{grid.width} * grid.height);
  for (const protocol::MaskRun& run : slice.mask_runs) labels.insert(labels.end(), run.count, run.label);
  MaskContours traced = trace_mask({grid.width, grid.height, labels});
  const auto to_mm = [&](const Eigen::Vector2d& pixel) -> Eigen::Vector2d {
    return (Eigen::Vector2d(grid.x_px, grid.y_px) + grid.step_px * pixel).cwiseProduct(pixel_size_mm);
  };
  std::transform(traced.points.begin(), traced.points.end(), traced.points.begin(), to_mm);
  tracked.points = std::move(traced.points);
  tracked.contours = std::move(traced.contours);
  if (!tracked.field_of_view.empty()) return;
  const double right = grid.width - 0.5, bottom = grid.height - 0.5;
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d(-0.5, -0.5), Eigen::Vector2d(right, -0.5),
                                        Eigen::Vector2d(right, bottom), Eigen::Vector2d(-0.5, bottom)}) {
    tracked.field_of_view.push_back(to_mm(corner));
  }
}

}  // namespace

Result<Calibration> make_calibration(const protocol::CalibrationMessage& message) {
  if (message.id == 0) {
    return fail(ErrorCode::not_available, "the device has no calibration: store one with SET_CALIBRATION");
  }
  const Eigen::Matrix<double, 3, 4> m =
      Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(message.image_to_probe);
  if (!m.allFinite()) {
    return fail(ErrorCode::non_finite, "the device's calibration has a number that is not finite: calibrate again");
  }
  const Eigen::Vector2d pixel_size_mm(m.col(0).norm(), m.col(1).norm());
  if (!pixel_size_mm.allFinite() || pixel_size_mm.minCoeff() < kMinPixelMm) {
    return fail(ErrorCode::not_rigid, "the device's calibration has pixels without a size: calibrate again");
  }
  const Eigen::Vector3d x = m.col(0) / pixel_size_mm.x();
  const Eigen::Vector3d y = m.col(1) / pixel_size_mm.y();
  if (std::abs(x.dot(y)) > kMaxSkew) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "the device's calibration has image axes at %.3f degrees, only 90 makes sense: calibrate again",
                  std::acos(std::clamp(x.dot(y), -1.0, 1.0)) * 180 / M_PI);
    return fail(ErrorCode::not_rigid, text);
  }
  Calibration calibration;
  calibration.id = message.id;
  calibration.pixel_size_mm = pixel_size_mm;
  const Eigen::Vector3d z = x.cross(y).normalized();
  calibration.image_to_probe.linear() << x, z.cross(x), z;
  calibration.image_to_probe.translation() = m.col(3);
  return calibration;
}

DeliveredSlice to_delivered(const protocol::Slice& slice, std::uint64_t seq, const Calibration& calibration,
                            std::chrono::steady_clock::time_point arrival) {
  assert(slice.calibration_id == calibration.id);
  const protocol::Pose& pose = slice.pose;
  DeliveredSlice delivered;
  delivered.pose_status = pose.status;
  delivered.pose_error_mm = pose.error_mm;
  delivered.pose_time = std::chrono::nanoseconds(pose.time_ns);
  delivered.arrival = arrival;

  Eigen::Isometry3d probe_to_reference = Eigen::Isometry3d::Identity();
  probe_to_reference.linear() = Eigen::Quaterniond(pose.qw, pose.qx, pose.qy, pose.qz).normalized().toRotationMatrix();
  probe_to_reference.translation() = Eigen::Vector3d(pose.tx_mm, pose.ty_mm, pose.tz_mm);

  TrackedSlice& tracked = delivered.slice;
  tracked.id = seq;
  tracked.time = std::chrono::nanoseconds(slice.time_ns);
  tracked.image_to_reference = probe_to_reference * calibration.image_to_probe;
  tracked.field_of_view = to_mm(slice.field_of_view, calibration.pixel_size_mm);
  if (slice.has_mask()) {
    add_mask(slice, calibration.pixel_size_mm, tracked);
  } else {
    add_contours(slice, calibration.pixel_size_mm, tracked);
  }
  return delivered;
}

}  // namespace sonoloft::device
