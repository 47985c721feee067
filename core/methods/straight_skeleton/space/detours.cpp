#include "core/methods/straight_skeleton/space/detours.h"

#include <algorithm>

namespace sonoloft::skeleton {
namespace {

using Eigen::Vector3d;

constexpr int kSteps = 32;
/// Of the distance at the start: what is taken for no difference.
constexpr double kAlike = 1e-3;

/// How far a point is outside of a cell, about; 0 within.
double outside(const FrontCell& cell, const Vector3d& p) {
  double value = 0;
  for (const FormPtr& facet : cell.facets) value = std::min(value, facet->near(p));
  return -value;
}

const FrontCell& cell_at(const Front& front, const Vector3d& p) {
  const FrontCell* best = &front.cells.front();
  double best_mm = outside(*best, p);
  for (const FrontCell& cell : front.cells) {
    if (best_mm == 0) break;
    if (const double at_mm = outside(cell, p); at_mm < best_mm) best = &cell, best_mm = at_mm;
  }
  return *best;
}

/// Whether another front is nearer somewhere on the straight way down to the rim, on which the distance shrinks evenly.
bool is_blocked(const Space& space, const Owner& owner, const Vector3d& from) {
  const Front& front = space.fronts[owner.front];
  const auto& [a, b] = front.footings[owner.cell->footing].rim;
  const Vector3d foot = a + std::clamp((from - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0) * (b - a);
  const double start_mm = owner.distance().near(from);
  for (int i = 1; i < kSteps; ++i) {
    const double way = 1.0 * i / kSteps, limit_mm = (1 - way - kAlike) * start_mm;
    const Vector3d p = from + way * (foot - from);
    for (const Front& other : space.fronts) {
      const FrontCell& first = other.cells.front();  // up from the patch: nothing is nearer than its plane
      if (&other == &front || std::abs(first.distance->near(p)) >= limit_mm) continue;
      if (cell_at(other, p).distance->near(p) < limit_mm) return true;
    }
  }
  return false;
}

}  // namespace

std::size_t count_detours(const Space& space, std::span<const Facet* const> facets) {
  return static_cast<std::size_t>(std::ranges::count_if(facets, [&](const Facet* facet) {
    Vector3d middle = Vector3d::Zero();
    for (const Corner& c : facet->polygon.corners)
      middle += c.rough / static_cast<double>(facet->polygon.corners.size());
    return std::ranges::any_of(std::array{facet->negative, facet->positive}, [&](const Owner& owner) {
      const Footing& footing = space.fronts[owner.front].footings[owner.cell->footing];
      return !footing.beyond->is_zero() && is_blocked(space, owner, middle);
    });
  }));
}

}  // namespace sonoloft::skeleton
