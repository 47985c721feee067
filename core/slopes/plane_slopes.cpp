#include "core/slopes/plane_slopes.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <tuple>

#include "core/slopes/windows.h"

namespace sonoloft {
namespace {

constexpr double kReach = 3;              ///< heights; borders farther off are of other parts of the object
constexpr double kLeastShare = 0.1;       ///< of the weights so far; planes that can add no more are left out
constexpr double kLeastAlong = 0.2;       ///< planes steeper than that end nothing along the normal
constexpr double kLeastSteepness = 1e-4;  ///< squared: of a surface along another plane

/// Cells are renewed side by side; what several of them write is the same.
template <class T>
void store(T& to, T value) {
  std::atomic_ref<T>(to).store(value, std::memory_order_relaxed);
}

/// How deep a point lies in the label of a contour's left side, of its right side taken away, halved: the distance to
/// the border where there are no other labels. None where the slice does not say.
std::optional<double> depth(const BorderTree& borders, const Arc& arc, const Eigen::Vector2d& point, double reach_mm,
                            std::uint32_t& hint) {
  const auto any = borders.nearest(point, reach_mm, std::nullopt, hint);
  if (!any) return std::nullopt;
  hint = any->block;
  if (any->left == kUnknown) return std::nullopt;
  const auto depth_in = [&](Label label) -> std::optional<double> {
    const bool is_border = any->left == label || any->right == label;
    const auto border = is_border ? any : borders.nearest(point, reach_mm, label, hint);
    if (!border || border->left == kUnknown) return std::nullopt;
    return any->label == label ? border->distance_mm : -border->distance_mm;
  };
  const auto left = depth_in(arc.left);
  const auto right = left ? depth_in(arc.right) : std::nullopt;
  if (!right) return std::nullopt;
  return 0.5 * (*left - *right);
}

}  // namespace

void PlaneSlopes::renew(const CellComplex& cells, CellId cell, std::span<const std::unique_ptr<SliceContours>> slices,
                        double feature_mm) {
  feature_mm_ = feature_mm;
  find_walls(cells, cell, slices);
  for (const Wall& wall : walls_) {
    find_places(cells, cell, wall);
    find_neighbours(wall);
    for (const std::uint32_t place : places_) {
      PlaneSums now = sum(wall, place);
      now.cell = static_cast<std::uint32_t>(cell);
      PlaneSums& held = wall.contours->sums[place][wall.above ? 1 : 0];
      if (held == now) continue;
      if (held.cell == kNoCell) store(wall.contours->walls_changed, std::uint8_t{1});
      held = now;
      store(wall.contours->arc_is_stale[wall.contours->arcs.arc[place]], std::uint8_t{1});
    }
  }
}

void PlaneSlopes::find_walls(const CellComplex& cells, CellId cell,
                             std::span<const std::unique_ptr<SliceContours>> slices) {
  cells.faces(cell, faces_);
  walls_.clear();
  for (const CellFace& face : faces_) {
    const auto slice = cells.slice_of(face.plane);
    if (!slice) continue;
    SliceContours* const contours = slices[static_cast<std::size_t>(*slice)].get();
    if (!contours->borders.empty()) walls_.push_back({*slice, contours, face.polygon, face.above, 0});
  }
}

/// The stations on a wall, in the order of arcs; each lies where the edge that starts there does.
void PlaneSlopes::find_places(const CellComplex& cells, CellId cell, const Wall& wall) {
  const Section& section = cells.section(wall.slice);
  const Arcs& arcs = wall.contours->arcs;
  places_.clear();
  for (const FaceEdge& e : *wall.polygon) {
    if (e.source == kNoSource) continue;
    const std::uint32_t place = arcs.place_of_edge[e.source];
    const Arc& arc = arcs.arc_at(place);
    const std::uint32_t next = arc.next(place);
    const bool turned = e.left < e.right;
    const bool starts = (turned ? e.b : e.a) == section.points[arcs.point[place]];
    const bool ends = (turned ? e.a : e.b) == section.points[arcs.point[next]];
    store(wall.contours->edge_cells[e.source][wall.above ? 1 : 0],
          starts && ends ? static_cast<std::uint32_t>(cell) : kSeveralCells);
    if (starts && wall.contours->is_station[place]) places_.push_back(place);
    if (ends && !arc.has_edge(next) && wall.contours->is_station[next]) places_.push_back(next);
  }
  std::sort(places_.begin(), places_.end());
}

void PlaneSlopes::find_neighbours(const Wall& wall) {
  const Eigen::Vector3d normal = wall.contours->normal();
  neighbours_.clear();
  for (Wall& other : walls_) {
    if (&other == &wall) continue;
    const double side = other.above ? -1 : 1;
    const double along = side * normal.dot(other.contours->normal());
    if (wall.above ? along > 0 : along < 0) neighbours_.push_back({&other, along, side, 0, Eigen::Vector2d::Zero(), 0});
  }
}

/// Each depth is a way in its own plane, along which the surface rises sqrt(1 + slope^2 - lean^2) times as much as
/// along `outward`; which is exact in a wedge. Newton's steps, since this holds the slope that is looked for.
double PlaneSlopes::solve(double weights) const {
  constexpr int kSteps = 3;
  constexpr double kLeastDescent = 0.25;  // of that with depths as they are: no wild steps
  double slope = 0;
  for (int step = 0; step < kSteps; ++step) {
    double excess = -slope * weights, descent = -weights;
    for (const Term& t : terms_) {
      const double lean = t.outside - slope * t.along;
      const double steepness = std::sqrt(std::max(1 + slope * slope - lean * lean, kLeastSteepness));
      const double factor = t.weight * t.height_mm * t.along;
      excess += factor * (t.depth_mm * steepness + t.height_mm * t.outside);
      descent += factor * t.depth_mm * (slope + lean * t.along) / steepness;
    }
    slope = std::clamp(slope - excess / std::min(descent, -kLeastDescent * weights), -kGreatestSlope, kGreatestSlope);
  }
  return slope;
}

PlaneSums PlaneSlopes::sum(const Wall& wall, std::uint32_t place) {
  const SliceContours& own = *wall.contours;
  const Eigen::Vector2d& point = own.calm.points[own.arcs.point[place]];
  const Eigen::Vector3d position = own.image_to_reference * Eigen::Vector3d(point.x(), point.y(), 0);
  const Eigen::Vector2d nu = own.shape.outward[place].cast<double>();
  const Eigen::Vector3d outward = own.image_to_reference.linear().leftCols<2>() * nu;
  const double least_height = kLeastHeight * feature_mm_;
  double nearness = 0;
  for (Neighbour& n : neighbours_) {
    const Eigen::Vector3d local = n.wall->contours->reference_to_image * position;
    n.height_mm = std::abs(local.z());
    n.foot = local.head<2>();
    const double height = std::max(n.height_mm, least_height);
    n.weight_bound = n.along * n.along * n.height_mm * n.height_mm / (height * height * height);
    if (std::abs(n.along) > kLeastAlong) nearness = std::max(nearness, std::abs(n.along) / height);
  }
  std::sort(neighbours_.begin(), neighbours_.end(), [](const Neighbour& a, const Neighbour& b) {
    return std::tuple(-a.weight_bound, a.wall->slice) < std::tuple(-b.weight_bound, b.wall->slice);
  });
  terms_.clear();
  double weights = 0;
  for (const Neighbour& n : neighbours_) {
    if (n.weight_bound <= kLeastShare * weights) break;
    const double height = std::max(n.height_mm, least_height);
    const auto v = depth(n.wall->contours->borders, own.arcs.arc_at(place), n.foot, kReach * height, n.wall->hint);
    if (!v) continue;
    const double off = *v / height;
    const double weight = 1 / (height * height * height * (1 + off * off * off * off));
    terms_.push_back({weight, n.height_mm, n.along, n.side * outward.dot(n.wall->contours->normal()), *v});
    weights += weight * n.height_mm * n.height_mm * n.along * n.along;
  }
  const double slopes = weights > 0 ? weights * solve(weights) : 0;
  return {kNoCell, static_cast<float>(slopes), static_cast<float>(weights), static_cast<float>(nearness * nearness)};
}

}  // namespace sonoloft
