#include "core/methods/metamorphosis/front_arrival.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sonoloft {
namespace {

/// Steps from a contour: nearer nodes are taken for that far away, so that they have a gradient, too.
constexpr float kNearest = 1e-3F;
/// Of the way, what is left at the least.
constexpr float kLeast = 1e-6F;
/// Nodes within so many steps of the contour that the front leaves: the way to the goal is straight there.
constexpr float kStart = 1;

/// The root of  sum of weight (value - W)^2 = (W / g)^2  below both values, g in steps of the grid; negative if none.
template <class Upwind>
float solve(const Upwind& x, const Upwind& y, float g) {
  const float a = x.weight + y.weight - 1 / (g * g), b = x.weight * x.value + y.weight * y.value,
              c = x.weight * x.value * x.value + y.weight * y.value * y.value;
  const float discriminant = b * b - a * c;
  if (discriminant < 0) return -1;
  const float root = c / (b + std::sqrt(discriminant));
  return root <= std::min(x.weight > 0 ? x.value : root, y.weight > 0 ? y.value : root) ? root : -1;
}

}  // namespace

FrontArrival::FrontArrival(const PlaneGrid& grid, const SlicePair& slices)
    : grid_(grid), slices_(slices), left_(grid.size(), 0), state_(grid.size(), State::far) {}

/// Of the two nodes beside along an axis that which the front passes first.
FrontArrival::Upwind FrontArrival::upwind(std::size_t node, std::ptrdiff_t step) const {
  const auto at = [&](std::ptrdiff_t steps) {
    return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(node) + steps * step);
  };
  const auto value = [&](std::size_t n) { return state_[n] == State::accepted ? left_[n] : -1.0F; };
  const std::ptrdiff_t side = value(at(1)) > value(at(-1)) ? 1 : -1;
  const float near = value(at(side));
  if (near < 0) return {0, 0, 0};
  const float far = value(at(2 * side));  // the outermost nodes are not swept, so two steps stay in the grid
  if (far < near) return {near, 1, near};
  return {(4 * near - far) / 3, 2.25F, near};
}

float FrontArrival::steps_to(std::size_t node, const std::vector<float>& distance_mm) const {
  return std::max(kNearest, std::abs(distance_mm[node]) / static_cast<float>(grid_.spacing_mm));
}

float FrontArrival::left_at(std::size_t node) const {
  const float g = to_goal(node);
  const Upwind x = upwind(node, 1), y = upwind(node, grid_.width);
  float left = solve(x, y, g);
  if (left < 0)
    left =
        solve(Upwind{x.first_order, x.weight > 0 ? 1.0F : 0, 0}, Upwind{y.first_order, y.weight > 0 ? 1.0F : 0, 0}, g);
  return left < 0 ? std::max(x.first_order, y.first_order) * g / (g + 1) : left;
}

void FrontArrival::march(const SweptParts& parts, std::uint32_t part) {
  const std::array<std::ptrdiff_t, 4> steps{-1, 1, -std::ptrdiff_t{grid_.width}, std::ptrdiff_t{grid_.width}};
  std::make_heap(heap_.begin(), heap_.end());
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end());
    const Trial next = heap_.back();
    heap_.pop_back();
    if (state_[next.node] == State::accepted) continue;
    state_[next.node] = State::accepted;
    for (const std::ptrdiff_t step : steps) {
      const auto beside = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(next.node) + step);
      if (parts.part_of[beside] != part || state_[beside] == State::accepted) continue;
      if (gone(beside) <= kStart) continue;
      const float left = left_at(beside);
      if (state_[beside] == State::trial && left <= left_[beside]) continue;
      left_[beside] = left;
      state_[beside] = State::trial;
      heap_.push_back({left, static_cast<std::uint32_t>(beside)});
      std::push_heap(heap_.begin(), heap_.end());
    }
  }
}

std::vector<NodeArrival> FrontArrival::over(const SweptParts& parts, std::uint32_t number) {
  const SweptPart& part = parts.parts[number];
  upwards_ = part.on_lower >= part.on_upper;
  for (const std::uint32_t node : part.nodes) {
    if (gone(node) > kStart) continue;
    left_[node] = to_goal(node) / (gone(node) + to_goal(node));
    state_[node] = State::trial;
    heap_.push_back({left_[node], node});
  }
  march(parts, number);
  std::vector<NodeArrival> arrivals;
  arrivals.reserve(part.nodes.size());
  for (const std::uint32_t node : part.nodes) {
    const float left = std::max(left_[node], kLeast);
    arrivals.push_back({upwards_ ? 1 - left : left, left / (to_goal(node) * static_cast<float>(grid_.spacing_mm))});
  }
  return arrivals;
}

}  // namespace sonoloft
