#pragma once
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "core/slice/section.h"
#include "tests/support/planes.h"

/// Slices of balls through a bounded field of view, for tests of what lies beyond it.
namespace sonoloft::test {

struct Ball {
  Eigen::Vector3d centre;
  double radius;
  Label label;
};

inline std::vector<Eigen::Vector2d> ring(const Eigen::Vector2d& centre, double radius, int corners) {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    points.push_back(centre + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return points;
}

inline void add_contour(TrackedSlice& slice, const std::vector<Eigen::Vector2d>& points, Label label) {
  const auto first = static_cast<std::uint32_t>(slice.points.size());
  slice.points.insert(slice.points.end(), points.begin(), points.end());
  slice.contours.push_back({first, static_cast<std::uint32_t>(points.size()), label, false});
}

/// What a plane sees of balls that do not cross each other.
inline TrackedSlice slice_of_balls(const Eigen::Isometry3d& frame, const std::vector<Ball>& balls,
                                   std::vector<Eigen::Vector2d> view = {}) {
  TrackedSlice slice;
  slice.image_to_reference = frame;
  slice.field_of_view = std::move(view);
  for (const Ball& ball : balls) {
    const Eigen::Vector3d local = frame.inverse(Eigen::Isometry) * ball.centre;
    const double r2 = ball.radius * ball.radius - local.z() * local.z();
    if (r2 > 0.01) add_contour(slice, ring(local.head<2>(), std::sqrt(r2), 96), ball.label);
  }
  return slice;
}

inline Section checked_section(const TrackedSlice& slice) {
  auto section = make_section(slice);
  if (!section) throw std::runtime_error(section.error().message);
  return std::move(*section);
}

/// A sector of 60 degrees from 4 to 62 mm, apex at the origin, middle along y.
inline std::vector<Eigen::Vector2d> sector_view() {
  std::vector<Eigen::Vector2d> view;
  const auto arc = [&](double radius, int from, int to, int step) {
    for (int degree = from; degree != to + step; degree += step) {
      const double angle = degree * std::numbers::pi / 180;
      view.push_back({radius * std::sin(angle), radius * std::cos(angle)});
    }
  };
  arc(62, -30, 30, 3);
  arc(4, 30, -30, -6);
  return view;
}

/// Where the image of slice i of a hand-held sweep lies: strokes of 200 slices over a body of some 120 mm around the
/// origin, one beside or across the other, steps of 0.6 mm, tremor 1.5 degrees and 0.15 mm.
inline std::vector<Eigen::Isometry3d> hand_sweep(int slices, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Isometry3d> frames;
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  for (int i = 0; i < slices; ++i) {
    const int stroke = i / 200;
    const double along = (i % 200 - 100) * 0.6, aside = stroke % 2 == 0 ? -20 : 20;
    const double direction = std::array{0.0, 0.0, 90.0, 90.0, 37.0}[static_cast<std::size_t>(stroke % 5)];
    for (double& t : turn) t = 0.9 * t + std::sqrt(1 - 0.81) * 1.5 * normal(rng);
    const auto tilt = [&](int axis) {
      return Eigen::AngleAxisd(turn[axis] * std::numbers::pi / 180, Eigen::Vector3d::Unit(axis));
    };
    const Eigen::Vector3d shake(normal(rng), normal(rng), normal(rng));
    Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
    frame.rotate(Eigen::AngleAxisd(direction * std::numbers::pi / 180, Eigen::Vector3d::UnitY()));
    frame.translate(Eigen::Vector3d(aside, -30, along) + 0.15 * shake);
    frame.rotate(tilt(0) * tilt(1) * tilt(2));
    frames.push_back(frame);
  }
  return frames;
}

/// A body of 3 labels, outside among them, for hand_sweep().
inline std::vector<Ball> body() {
  return {{{0, 0, 0}, 50, 1}, {{-15, 5, 10}, 14, 2}, {{20, 10, -12}, 10, 2}, {{5, -18, -20}, 4, 2}};
}

}  // namespace sonoloft::test
