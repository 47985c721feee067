#include "core/mesh/vertices/cell_vertex.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

namespace sonoloft::test {
namespace {

/// A slice and a surface through a cell: both are planes, normal . x = offset, in lattice steps.
struct Passage {
  Eigen::Vector3d slice_normal, surface_normal;
  double slice_offset, surface_offset;
  [[nodiscard]] double height(const Eigen::Vector3d& p) const { return slice_normal.dot(p) - slice_offset; }
};

Eigen::Vector3d corner(unsigned c) {
  return {double(c & 1), double(c >> 1 & 1), double(c >> 2 & 1)};
}

/// The shares near a straight contour, as they are by the field's definition: half of 1 plus and minus the sine of the
/// angle under which the border is seen beside the slice's normal.
CellSamples samples_of(const Passage& passage, bool with_distances) {
  CellSamples cell{};
  cell.label_count = 2;
  cell.label = {kOutside, 1};
  const Eigen::Vector3d& n = passage.slice_normal;
  const Eigen::Vector3d across = passage.surface_normal - passage.surface_normal.dot(n) * n;
  for (unsigned c = 0; c < 8; ++c) {
    const double height = std::abs(passage.height(corner(c)));
    const double away = (passage.surface_normal.dot(corner(c)) - passage.surface_offset) / across.norm();
    const double sine = away / std::hypot(away, height);
    cell.share[0][c] = static_cast<float>((1 - sine) / 2);
    cell.share[1][c] = static_cast<float>((1 + sine) / 2);
    cell.owner[c] = sine > 0 ? 1 : 0;
    cell.corners[cell.owner[c]] |= static_cast<std::uint8_t>(1u << c);
    cell.slice_steps[c] =
        with_distances ? static_cast<float>(std::min<double>(height, kFarFromSlices)) : kFarFromSlices;
  }
  return cell;
}

/// How far crossings are from where the surface crosses the edges: the largest, in lattice steps.
double largest_error(const Passage& passage, bool with_distances) {
  const CellSamples cell = samples_of(passage, with_distances);
  double largest = 0;
  for (unsigned axis = 0; axis < 3; ++axis)
    for (unsigned rest = mixed_edges(cell, axis); rest != 0; rest &= rest - 1) {
      const auto lower = static_cast<unsigned>(std::countr_zero(rest));
      const double from = passage.surface_normal.dot(corner(lower)) - passage.surface_offset;
      const double exact = std::clamp(-from / passage.surface_normal[axis], 0.01, 0.99);
      largest = std::max(largest, std::abs(crossing(cell, lower, lower | 1u << axis) - exact));
    }
  return largest;
}

}  // namespace

TEST_CASE("mesh: beside a slice a surface is found where it is, whatever the angle between both") {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> where(0.1, 0.9);
  double with = 0, without = 0;
  int passages = 0;
  while (passages < 1000) {
    Passage passage{Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized(),
                    Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized(), 0, 0};
    if (std::abs(passage.slice_normal.dot(passage.surface_normal)) > 0.9) continue;  // the slice hardly shows it
    passage.slice_offset = passage.slice_normal.dot(Eigen::Vector3d(where(random), where(random), where(random)));
    passage.surface_offset = passage.surface_normal.dot(Eigen::Vector3d(where(random), where(random), where(random)));
    double nearest = 1;
    for (unsigned c = 0; c < 8; ++c) nearest = std::min(nearest, std::abs(passage.height(corner(c))));
    if (nearest < 0.02) continue;
    ++passages;
    with = std::max(with, largest_error(passage, true));
    without = std::max(without, largest_error(passage, false));
  }
  MESSAGE("largest error: ", with, " of an edge; by the shares alone ", without);
  CHECK(with < 1e-3);
  CHECK(without > 0.1);
}

}  // namespace sonoloft::test
