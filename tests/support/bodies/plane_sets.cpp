#include "tests/support/bodies/plane_sets.h"

#include <cmath>
#include <numbers>

#include "device_sim/probe/random.h"
#include "tests/support/phantom_section.h"

namespace sonoloft::test {
namespace {

using Planes = std::vector<Eigen::Isometry3d>;
using device_sim::Random;

/// The longest, the middle and the shortest side.
struct Sides {
  explicit Sides(const Eigen::Vector3d& sizes) {
    sizes.maxCoeff(&longest);
    sizes.minCoeff(&shortest);
    if (longest == shortest) shortest = (longest + 1) % 3;
    middle = 3 - longest - shortest;
  }
  int longest, middle, shortest;
};

/// @param start  where in its interval each plane lies, 0..1
Eigen::Isometry3d across(const Eigen::AlignedBox3d& box, int axis, std::size_t i, std::size_t count, double start) {
  Eigen::Vector3d point = box.center();
  point[axis] = box.min()[axis] + (static_cast<double>(i) + start) / static_cast<double>(count) * box.sizes()[axis];
  return plane_at(point, Eigen::Vector3d::Unit(axis));
}

Planes two_directions(const Eigen::AlignedBox3d& box, std::size_t count, double start) {
  const Sides sides(box.sizes());
  Planes planes;
  for (std::size_t i = 0; i < count; ++i)
    planes.push_back(i % 2 == 0 ? across(box, sides.longest, i / 2, (count + 1) / 2, start)
                                : across(box, sides.shortest, i / 2, count / 2, start));
  return planes;
}

/// The line runs along the middle side, half the longest side beyond the box along the shortest.
Planes fan(const Eigen::AlignedBox3d& box, std::size_t count, double start) {
  const Sides sides(box.sizes());
  Eigen::Vector3d line = box.center();
  line[sides.shortest] += 0.5 * (box.sizes()[sides.shortest] + box.sizes()[sides.longest]);
  const double half_angle =
      std::atan2(box.sizes()[sides.longest], (box.sizes()[sides.longest] + box.sizes()[sides.shortest]));
  Planes planes;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = half_angle * (2 * (static_cast<double>(i) + start) / static_cast<double>(count) - 1);
    planes.push_back(plane_at(line, std::cos(angle) * Eigen::Vector3d::Unit(sides.longest) +
                                        std::sin(angle) * Eigen::Vector3d::Unit(sides.shortest)));
  }
  return planes;
}

Planes freehand(const Eigen::AlignedBox3d& box, std::size_t count, double start, Random& random) {
  const Sides sides(box.sizes());
  constexpr double kSway = 20 * std::numbers::pi / 180;
  const double phase_1 = 6.28 * random.uniform(), phase_2 = 6.28 * random.uniform();
  Planes planes;
  for (std::size_t i = 0; i < count; ++i) {
    const double along = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    Eigen::Vector3d normal = Eigen::Vector3d::Unit(sides.longest);
    normal[sides.middle] = std::tan(kSway) * std::sin(1.5 * along + phase_1);
    normal[sides.shortest] = std::tan(kSway) * std::sin(2.5 * along + phase_2);
    planes.push_back(plane_at(across(box, sides.longest, i, count, start).translation(), normal));
  }
  return planes;
}

Planes random_planes(std::span<const Eigen::Vector3f> surface, std::size_t count, Random& random) {
  Planes planes;
  for (std::size_t i = 0; i < count; ++i) {
    const auto vertex = static_cast<std::size_t>(random.uniform() * static_cast<double>(surface.size()));
    planes.push_back(plane_at(surface[vertex].cast<double>(), random.normal3()));
  }
  return planes;
}

}  // namespace

Planes make_planes(PlaneSet set, std::size_t count, std::span<const Eigen::Vector3f> surface, std::uint64_t seed) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& p : surface) box.extend(p.cast<double>());
  Random random(seed);
  const double start = 0.25 + 0.5 * random.uniform();
  switch (set) {
    case PlaneSet::two_directions:
      return two_directions(box, count, start);
    case PlaneSet::fan:
      return fan(box, count, start);
    case PlaneSet::freehand:
      return freehand(box, count, start, random);
    case PlaneSet::random:
      return random_planes(surface, count, random);
    case PlaneSet::stack:
      break;
  }
  Planes planes;
  for (std::size_t i = 0; i < count; ++i) planes.push_back(across(box, Sides(box.sizes()).longest, i, count, start));
  return planes;
}

}  // namespace sonoloft::test
