#include "tests/support/masks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/slice/section.h"
#include "device_sim/probe/random.h"

namespace sonoloft::test {
namespace {

using device_sim::Random;
using Eigen::Vector2d;
using Polygon = std::vector<Vector2d>;
constexpr double kTurn = 2 * std::numbers::pi;

Eigen::AlignedBox2d box_of(const TrackedSlice& slice) {
  Eigen::AlignedBox2d box;
  for (const Vector2d& p : slice.points) box.extend(p);
  return box;
}

/// What of a slice has a label.
struct Labelled {
  Polygon points;  ///< spread evenly over it: shares of them are shares of the area
  double area = 0;
};

Labelled labelled(const TrackedSlice& slice, Random& random) {
  constexpr std::size_t kPoints = 1000, kTries = 40 * kPoints;
  Labelled result;
  if (slice.contours.empty()) return result;
  const Section section = make_section(slice).value();
  const Eigen::AlignedBox2d box = box_of(slice);
  std::size_t tries = 0;
  for (; tries < kTries && result.points.size() < kPoints; ++tries) {
    const double x = random.uniform(), y = random.uniform();
    const Vector2d p = box.min() + Vector2d(x, y).cwiseProduct(box.sizes());
    if (label_at(section, p) != kOutside) result.points.push_back(p);
  }
  result.area = box.sizes().prod() * static_cast<double>(result.points.size()) / static_cast<double>(tries);
  return result;
}

Vector2d any_of(const Polygon& points, Random& random) {
  return points[static_cast<std::size_t>(random.uniform() * static_cast<double>(points.size()))];
}

/// The value below which a share of the values lies.
double quantile(std::vector<double> values, double share) {
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// A rectangle with these half sides, x along `direction`.
Polygon rectangle(const Vector2d& middle, const Vector2d& direction, double half_x, double half_y) {
  const Vector2d x = half_x * direction, y = half_y * Vector2d(-direction.y(), direction.x());
  return {middle - x - y, middle + x - y, middle + x + y, middle - x + y};
}

Vector2d random_direction(Random& random) {
  const double angle = kTurn * random.uniform();
  return {std::cos(angle), std::sin(angle)};
}

struct Disc {
  Vector2d middle;
  double radius;  ///< of its corners
};
constexpr int kCorners = 14;
/// The radius of a circle of the same area, over that of the corners.
const double kRound = std::sqrt(std::sin(kTurn / kCorners) * kCorners / kTurn);

/// Discs that do not touch and cover the share of the points. They start with 1/25 of the labelled area each and become
/// smaller where none fits any more.
std::vector<Disc> blobs(const Labelled& all, double share, Random& random) {
  constexpr double kLargest = 1.0 / 25, kShrink = 0.97;
  const auto wanted = static_cast<std::size_t>(share * static_cast<double>(all.points.size()));
  std::vector<Disc> discs;
  std::size_t covered = 0;
  for (double radius = std::sqrt(kLargest * all.area * 2 / kTurn); covered < wanted; radius *= kShrink) {
    const Vector2d middle = any_of(all.points, random);
    double free = radius;
    for (const Disc& other : discs) free = std::min(free, (other.middle - middle).norm() - other.radius);
    if (free < radius) continue;
    std::vector<double> distances;
    for (const Vector2d& p : all.points)
      if ((p - middle).norm() <= kRound * radius) distances.push_back((p - middle).norm());
    const std::size_t missing = wanted - covered;
    if (distances.size() > missing) {  // the last one
      const auto nth = distances.begin() + static_cast<std::ptrdiff_t>(missing);
      std::nth_element(distances.begin(), nth, distances.end());
      radius = *nth / kRound;
    }
    discs.push_back({middle, radius});
    covered += std::min(distances.size(), missing);
    radius /= kShrink;
  }
  return discs;
}

/// All of a large square but for the discs, as one polygon: every disc is reached and left by the same way, which
/// cancels (even-odd).
Polygon all_but(const std::vector<Disc>& discs, const Polygon& square) {
  Polygon view = square;
  for (const Disc& disc : discs) {
    for (int i = 0; i <= kCorners; ++i) {
      const double angle = kTurn * (i % kCorners) / kCorners;
      view.push_back(disc.middle + disc.radius * Vector2d(std::cos(angle), std::sin(angle)));
    }
    view.push_back(square.back());
  }
  return view;
}

Polygon half_plane(const Polygon& points, double share, double far, Random& random) {
  const Vector2d direction = random_direction(random);
  std::vector<double> along;
  for (const Vector2d& p : points) along.push_back(p.dot(direction));
  const double edge = quantile(along, 1 - share);
  const Vector2d on_edge = points[0] + (edge - points[0].dot(direction)) * direction;
  return rectangle(on_edge - far * direction, direction, far, 2 * far);
}

/// Twice as long as wide at most.
Polygon window(const Polygon& points, double share, Random& random) {
  const Vector2d middle = any_of(points, random), direction = random_direction(random);
  const double aspect = 1 + random.uniform();
  std::vector<double> sizes;
  for (const Vector2d& p : points) {
    const Vector2d d = p - middle;
    sizes.push_back(
        std::max(std::abs(d.dot(direction)) / aspect, std::abs(d.dot(Vector2d(-direction.y(), direction.x())))));
  }
  const double half = quantile(sizes, 1 - share);
  return rectangle(middle, direction, aspect * half, half);
}

}  // namespace

std::vector<TrackedSlice> masked(std::span<const TrackedSlice> slices, Mask mask, double share, std::uint64_t seed) {
  Eigen::AlignedBox3d box;
  for (const TrackedSlice& slice : slices)
    for (const Vector2d& p : slice.points) box.extend(slice.image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0));
  const double far = 8 * box.diagonal().norm();  // beyond the box of any reconstruction
  std::vector<TrackedSlice> result(slices.begin(), slices.end());
  for (std::size_t i = 0; i < result.size(); ++i) {
    Random random(seed, i);
    const Labelled all = labelled(result[i], random);
    if (all.points.empty()) continue;
    Polygon& view = result[i].field_of_view;
    if (mask == Mask::blobs)
      view = all_but(blobs(all, share, random), rectangle(box_of(result[i]).center(), Vector2d::UnitX(), far, far));
    else if (mask == Mask::half_plane)
      view = half_plane(all.points, share, far, random);
    else
      view = window(all.points, share, random);
  }
  return result;
}

}  // namespace sonoloft::test
