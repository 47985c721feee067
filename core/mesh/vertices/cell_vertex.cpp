#include "core/mesh/vertices/cell_vertex.h"

#include <Eigen/LU>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>

namespace sonoloft {
namespace {

constexpr unsigned kAllCorners = 0xFF;
constexpr float kEdgeMargin = 0.01F;
constexpr float kCellMargin = 0.03F;
constexpr float kRelaxation = 0.85F;
constexpr float kLongestStep = 0.5F;
/// Least distance from a slice and least cosine^2: samples on a slice say on which side of a border they are, no more.
constexpr float kNearestSlice = 1e-3F, kLeastCos2 = 1e-6F;
/// Interfaces whose normals span less than this (squared sine) do not say where they meet.
constexpr float kParallel = 1e-3F;

/// Corners of the faces, in the order of the bits of mixed_faces().
constexpr std::array<unsigned, 6> kFaces = {0x55, 0xAA, 0x33, 0xCC, 0x0F, 0xF0};
const std::array<Eigen::Vector3f, 8> kCorners = {
    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}}};

/// The faces that a set of corners touches.
constexpr auto kTouchedFaces = [] {
  std::array<std::uint8_t, 256> touched{};
  for (unsigned corners = 0; corners < 256; ++corners)
    for (unsigned face = 0; face < 6; ++face)
      if ((corners & kFaces[face]) != 0) touched[corners] |= static_cast<std::uint8_t>(1u << face);
  return touched;
}();

constexpr bool connected_along_edges(unsigned corners) {
  unsigned reached = corners & (0u - corners);
  for (int step = 0; step < 7; ++step)
    for (unsigned c = 0; c < 8; ++c)
      if (reached >> c & 1) reached |= corners & (1u << (c ^ 1) | 1u << (c ^ 2) | 1u << (c ^ 4));
  return reached == corners;
}

constexpr auto kSimple = [] {
  std::array<bool, 256> simple{};
  for (unsigned corners = 0; corners < 256; ++corners)
    simple[corners] = connected_along_edges(corners) && connected_along_edges(~corners & kAllCorners);
  return simple;
}();

/// The trilinear function of 8 corner values and its gradient at p.
float trilinear(const float* g, const Eigen::Vector3f& p, Eigen::Vector3f& gradient) {
  const float d00 = g[1] - g[0], d10 = g[3] - g[2], d01 = g[5] - g[4], d11 = g[7] - g[6];
  const float x00 = g[0] + p.x() * d00, x10 = g[2] + p.x() * d10;
  const float x01 = g[4] + p.x() * d01, x11 = g[6] + p.x() * d11;
  const float y0 = x00 + p.y() * (x10 - x00), y1 = x01 + p.y() * (x11 - x01);
  const float d0 = d00 + p.y() * (d10 - d00), d1 = d01 + p.y() * (d11 - d01);
  gradient = {d0 + p.z() * (d1 - d0), (x10 - x00) + p.z() * ((x11 - x01) - (x10 - x00)), y1 - y0};
  return y0 + p.z() * (y1 - y0);
}

/// The shortest step after which all K linearised gaps vanish; none where they are nearly parallel or not numbers.
template <int K>
Eigen::Vector3f newton_step(const float* gaps, const Eigen::Vector3f& p) {
  Eigen::Matrix<float, 3, K> gradients;
  Eigen::Matrix<float, K, 1> values;
  for (int k = 0; k < K; ++k) {
    Eigen::Vector3f gradient;
    values[k] = trilinear(gaps + 8 * k, p, gradient);
    gradients.col(k) = gradient;
  }
  const Eigen::Matrix<float, K, K> gram = gradients.transpose() * gradients;
  if (!(gram.determinant() > kParallel * gram.diagonal().prod())) return Eigen::Vector3f::Zero();
  Eigen::Vector3f step = -(gradients * (gram.inverse() * values));
  const float length = step.norm();
  if (!(length <= kLongestStep)) step *= kLongestStep / length;
  return step.allFinite() ? step : Eigen::Vector3f::Zero();
}

/// From the difference of two labels' shares to something of the same sign that is linear along an edge. At a distance
/// h from a slice the difference is the sine of the angle between the slice's normal and the direction in which the
/// border on the slice is seen, of which h * tangent is linear in space; the sine alone, which is flat above a border
/// and steep beside it, would put the border up to half an edge beside its place.
float way_to_border(float difference, float slice_steps) {
  const float tangent = difference / std::sqrt(std::max(1 - difference * difference, kLeastCos2));
  return slice_steps < kFarFromSlices ? std::max(slice_steps, kNearestSlice) * tangent : kFarFromSlices * difference;
}

float zero_between(float lower, float upper) {
  const float t = lower / (lower - upper);
  if (!(std::abs(t) <= 1e6F)) return 0.5F;  // 0/0, NaN: the samples do not say
  return std::clamp(t, kEdgeMargin, 1 - kEdgeMargin);
}

Eigen::Vector3f keep_inside(const Eigen::Vector3f& p) {
  return p.cwiseMax(kCellMargin).cwiseMin(1 - kCellMargin);
}

CellPoint finish(const Eigen::Vector3f& start, const float* gaps, int equations) {
  Eigen::Vector3f p = keep_inside(start);
  if (equations == 1) p += newton_step<1>(gaps, p);
  if (equations == 2) p += newton_step<2>(gaps, p);
  return to_cell_point(p);
}

}  // namespace

bool is_simple(const CellSamples& cell) {
  return std::all_of(cell.corners.begin(), cell.corners.begin() + cell.label_count,
                     [](std::uint8_t corners) { return kSimple[corners]; });
}

unsigned faces_with_all_labels(const CellSamples& cell) {
  unsigned faces = ~0u;
  for (std::size_t i = 0; i < static_cast<std::size_t>(cell.label_count); ++i) faces &= kTouchedFaces[cell.corners[i]];
  return faces;
}

unsigned mixed_faces(const CellSamples& cell) {
  unsigned touched = 0, mixed = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(cell.label_count); ++i) {
    mixed |= touched & kTouchedFaces[cell.corners[i]];
    touched |= kTouchedFaces[cell.corners[i]];
  }
  return mixed;
}

unsigned mixed_edges(const CellSamples& cell, unsigned axis) {
  constexpr std::array<unsigned, 3> kLower = {0x55, 0x33, 0x0F};
  unsigned mixed = 0;
  for (std::size_t i = 1; i < static_cast<std::size_t>(cell.label_count); ++i)
    mixed |= cell.corners[i] ^ static_cast<unsigned>(cell.corners[i]) >> (1u << axis);
  return mixed & kLower[axis];
}

float crossing(const CellSamples& cell, unsigned lower, unsigned upper) {
  const auto& a = cell.share[cell.owner[lower]];
  const auto& b = cell.share[cell.owner[upper]];
  return zero_between(way_to_border(a[lower] - b[lower], cell.slice_steps[lower]),
                      way_to_border(a[upper] - b[upper], cell.slice_steps[upper]));
}

float crossing(const CellSamples& cell, const Gaps& gaps, unsigned lower, unsigned upper) {
  if (cell.label_count > 2) return crossing(cell, lower, upper);
  return zero_between(gaps[0][lower], gaps[0][upper]);  // the same bits, whichever of both labels is first
}

int gaps_of(const CellSamples& cell, Gaps& gaps) {
  const int equations = cell.label_count - 1;
  if (equations > kMaxEquations) return 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(equations); ++k)
    for (std::size_t c = 0; c < 8; ++c)
      gaps[k][c] = way_to_border(cell.share[0][c] - cell.share[k + 1][c], cell.slice_steps[c]);
  return equations;
}

Eigen::Vector3f to_steps(const CellPoint& point) {
  return Eigen::Vector3f(static_cast<float>(point[0]), static_cast<float>(point[1]), static_cast<float>(point[2])) /
         static_cast<float>(kStep);
}

CellPoint to_cell_point(const Eigen::Vector3f& steps) {
  const Eigen::Vector3f p = keep_inside(steps);
  return {to_fixed(p.x()), to_fixed(p.y()), to_fixed(p.z())};
}

CellPoint place_vertex(const CellSamples& cell, const Gaps& gaps, int equations) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  int crossings = 0;
  for (unsigned axis = 0; axis < 3; ++axis)
    for (unsigned rest = mixed_edges(cell, axis); rest != 0; rest &= rest - 1) {
      const auto lower = static_cast<unsigned>(std::countr_zero(rest));
      sum += kCorners[lower];
      sum[axis] += crossing(cell, gaps, lower, lower | 1u << axis);
      ++crossings;
    }
  return finish(sum / static_cast<float>(crossings), gaps[0].data(), equations);
}

Eigen::Vector3f normal_at(const CellPoint& vertex, const float* gaps) {
  Eigen::Vector3f gradient;
  (void)trilinear(gaps, to_steps(vertex), gradient);
  const float length = gradient.norm();
  return length > 0 && length <= std::numeric_limits<float>::max() ? Eigen::Vector3f(gradient / length)
                                                                   : Eigen::Vector3f::Zero();
}

CellPoint relax_vertex(const CellPoint& vertex, const Eigen::Vector3f& mean, const float* gaps, int equations) {
  const Eigen::Vector3f p = to_steps(vertex);
  return finish(p + kRelaxation * (mean - p), gaps, equations);
}

}  // namespace sonoloft
