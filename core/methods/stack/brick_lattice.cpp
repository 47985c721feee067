#include "core/methods/stack/brick_lattice.h"

#include <algorithm>

#include "core/octree/grid_walk.h"

namespace sonoloft {

void BrickLattice::add(std::unique_ptr<Brick> brick) {
  const BrickCoord coord = brick->coord;
  places_[coord].brick = std::move(brick);
}

void BrickLattice::add_contours(const Section& section, SliceId slice) {
  const auto steps = [&](const Eigen::Vector2d& p) -> Eigen::Vector3d {
    return (section.image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0) - origin_mm_) / spacing_mm_;
  };
  for (const SectionEdge& e : section.edges) {
    const Eigen::Vector3d a = steps(section.points[e.a]), b = steps(section.points[e.b]);
    const auto [lower, upper] = std::minmax(e.left, e.right);
    walk_grid(a / kBrickSize, b / kBrickSize, [&, lower = lower, upper = upper](double from, double to) {
      const Eigen::Vector3d p = a + from * (b - a), q = a + to * (b - a);
      const Eigen::Vector3i at = (0.5 * (p + q) / kBrickSize).array().floor().cast<int>();
      const auto place = places_.find({at.x(), at.y(), at.z()});
      if (place == places_.end()) return;
      const Eigen::Vector3d base = kBrickSize * at.cast<double>();
      place->second.contours.push_back(
          {(p - base).cast<float>(), (q - base).cast<float>(), lower, upper, slice, from == 0.0, to == 1.0});
    });
  }
}

const Brick* BrickLattice::find(BrickCoord coord) const {
  const auto place = places_.find(coord);
  return place == places_.end() ? nullptr : place->second.brick.get();
}

std::span<const ContourPiece> BrickLattice::contours(BrickCoord coord) const {
  const auto place = places_.find(coord);
  return place == places_.end() ? std::span<const ContourPiece>() : place->second.contours;
}

std::vector<BrickCoord> BrickLattice::bricks() const {
  std::vector<BrickCoord> coords;
  for (const auto& [coord, place] : places_) coords.push_back(coord);
  std::ranges::sort(coords);
  return coords;
}

}  // namespace sonoloft
