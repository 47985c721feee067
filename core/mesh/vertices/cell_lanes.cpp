#include "core/mesh/vertices/cell_lanes.h"

#include <Eigen/LU>
#include <limits>

#include "core/mesh/vertices/cell_vertex.h"

namespace sonoloft {
namespace {

constexpr float kCellMargin = 0.03F;
constexpr float kLongestStep = 0.5F;
constexpr float kLargest = std::numeric_limits<float>::max();
/// Interfaces whose normals span less than this (squared sine) do not say where they meet.
constexpr float kParallel = 1e-3F;

template <class T>
struct Gradient {
  T x, y, z;
};

/// The trilinear function of 8 corner values and its gradient.
template <class T>
T trilinear(const T* g, T x, T y, T z, Gradient<T>& gradient) {
  const T d00 = g[1] - g[0], d10 = g[3] - g[2], d01 = g[5] - g[4], d11 = g[7] - g[6];
  const T x00 = g[0] + x * d00, x10 = g[2] + x * d10;
  const T x01 = g[4] + x * d01, x11 = g[6] + x * d11;
  const T y0 = x00 + y * (x10 - x00), y1 = x01 + y * (x11 - x01);
  const T d0 = d00 + y * (d10 - d00), d1 = d01 + y * (d11 - d01);
  gradient = {d0 + z * (d1 - d0), (x10 - x00) + z * ((x11 - x01) - (x10 - x00)), y1 - y0};
  return y0 + z * (y1 - y0);
}

template <class T>
T keep_inside(T p) {
  const T least = T{} + kCellMargin, most = T{} + (1 - kCellMargin);
  const T above = p < least ? least : p;
  return above > most ? most : above;
}

/// The shortest step after which the linearised gap vanishes, in every lane; none where it is flat or not a number.
void newton_steps(const GapLanes& gaps, PointLanes& p) {
  Gradient<Four> g;
  const Four value = trilinear(gaps.corner, p.axis[0], p.axis[1], p.axis[2], g);
  const Four gram = g.x * g.x + (g.y * g.y + g.z * g.z), way = 1 / gram * value;
  PointLanes step{{-(g.x * way), -(g.y * way), -(g.z * way)}};
  const auto& [x, y, z] = step.axis;
  const Four length = square_root(x * x + (y * y + z * z));
  const Four factor = length <= kLongestStep ? Four{} + 1 : kLongestStep / length;
  for (Four& of_axis : step.axis) of_axis *= factor;
  const Four zero = 0 * x + (0 * y + 0 * z);  // unless the step is not finite
  const FourInts take = (gram > kParallel * gram) & (zero == zero);
  for (std::size_t axis = 0; axis < 3; ++axis) p.axis[axis] += take ? step.axis[axis] : Four{};
}

/// The shortest step after which both linearised gaps vanish; none where they are nearly parallel or not numbers.
Eigen::Vector3f newton_step(const std::array<Gap, 2>& gaps, const Eigen::Vector3f& p) {
  Eigen::Matrix<float, 3, 2> gradients;
  Eigen::Vector2f values;
  for (int k = 0; k < 2; ++k) {
    Gradient<float> g;
    values[k] = trilinear(gaps[static_cast<std::size_t>(k)].data(), p.x(), p.y(), p.z(), g);
    gradients.col(k) = Eigen::Vector3f(g.x, g.y, g.z);
  }
  const Eigen::Matrix2f gram = gradients.transpose() * gradients;
  if (!(gram.determinant() > kParallel * gram.diagonal().prod())) return Eigen::Vector3f::Zero();
  Eigen::Vector3f step = -(gradients * (gram.inverse() * values));
  const float length = step.norm();
  if (!(length <= kLongestStep)) step *= kLongestStep / length;
  return step.allFinite() ? step : Eigen::Vector3f::Zero();
}

}  // namespace

PointLanes mean_of_crossings(const CrossingLanes& crossings, const GapLanes& gaps) {
  PointLanes sum{};
  Four count{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t edge = 0; edge < 4; ++edge) {
      const unsigned lower = kLowerEnds[axis][edge];
      const Four of_gaps = zero_between(gaps.corner[lower], gaps.corner[lower | 1u << axis]);
      const Four crossing = crossings.known ? crossings.crossing[axis][edge] : of_gaps;
      const FourInts mixed = (crossings.mixed[axis] >> static_cast<int>(lower) & 1) != 0;
      const Four one = mixed ? Four{} + 1 : Four{};
      count += one;
      sum.axis[axis] += mixed ? crossing : Four{};
      for (std::size_t other = 0; other < 3; ++other)
        if (lower >> other & 1) sum.axis[other] += one;
    }
  count = count > 0 ? count : Four{} + 1;
  for (Four& of_axis : sum.axis) of_axis /= count;
  return sum;
}

std::array<CellPoint, kFour> step_to_surface(const PointLanes& start, const GapLanes& gaps,
                                             std::span<const LineGaps> lines) {
  PointLanes p;
  for (std::size_t axis = 0; axis < 3; ++axis) p.axis[axis] = keep_inside(start.axis[axis]);
  newton_steps(gaps, p);
  for (const LineGaps& line : lines) {
    const std::size_t lane = line.slot % kFour;
    const Eigen::Vector3f at(p.axis[0][lane], p.axis[1][lane], p.axis[2][lane]), step = newton_step(line.gap, at);
    for (std::size_t axis = 0; axis < 3; ++axis) p.axis[axis][lane] += step[static_cast<Eigen::Index>(axis)];
  }
  std::array<CellPoint, kFour> points;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const FourInts fixed = __builtin_convertvector(keep_inside(p.axis[axis]) * kStep + 0.5F, FourInts);
    for (std::size_t i = 0; i < kFour; ++i) points[i][axis] = static_cast<std::uint16_t>(fixed[i]);
  }
  return points;
}

Eigen::Vector3f to_steps(const CellPoint& point) {
  return Eigen::Vector3f(static_cast<float>(point[0]), static_cast<float>(point[1]), static_cast<float>(point[2])) /
         static_cast<float>(kStep);
}

CellPoint to_cell_point(const Eigen::Vector3f& steps) {
  return {to_fixed(keep_inside(steps.x())), to_fixed(keep_inside(steps.y())), to_fixed(keep_inside(steps.z()))};
}

Eigen::Vector3f normal_at(const CellPoint& vertex, const Gap& gap) {
  const Eigen::Vector3f p = to_steps(vertex);
  Gradient<float> g;
  (void)trilinear(gap.data(), p.x(), p.y(), p.z(), g);
  const Eigen::Vector3f gradient(g.x, g.y, g.z);
  const float length = gradient.norm();
  return length > 0 && length <= kLargest ? Eigen::Vector3f(gradient / length) : Eigen::Vector3f::Zero();
}

}  // namespace sonoloft
