#include "core/octree/contour_news.h"

#include <algorithm>
#include <tuple>

#include "core/octree/grid_walk.h"

namespace sonoloft {
namespace {

Eigen::Vector3d first_sample(const WorkBrick& brick) {
  return Eigen::Vector3i(brick.coord.x, brick.coord.y, brick.coord.z).cast<double>() * kBrickSize;
}

/// Of a piece, in lattice steps.
Eigen::Vector3d middle(const WorkBrick& brick, const ContourPiece& piece) {
  return first_sample(brick) + 0.5 * (piece.a + piece.b).cast<double>();
}

Octant octant_at(const Eigen::Vector3d& steps) {
  const Eigen::Vector3i at = (steps / kOctantCells).array().floor().cast<int>();
  return {at.x(), at.y(), at.z()};
}

}  // namespace

void ContourNews::add(const CellComplex& cells, const CellComplex::Delta& delta) {
  std::vector<CellFace> faces;
  for (const CellId cell : delta.upper) {
    cells.faces(cell, faces);
    for (const CellFace& face : faces) {
      if (face.plane != delta.plane) continue;
      const auto lift = [&](const Eigen::Vector2d& p) -> Eigen::Vector3d {
        return *face.image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0.0);
      };
      for (const FaceEdge& e : *face.polygon) {
        if (e.right == kBeyondFace || e.left == kUnknown || e.right == kUnknown) continue;
        const auto [lower, upper] = std::minmax({e.left, e.right});
        new_.push_back({lift(e.a), lift(e.b), lower, upper, delta.slice});
      }
    }
  }
}

void ContourNews::remove(const CellComplex& cells, const CellComplex::Withdrawal& withdrawal, BrickPool& bricks) {
  std::vector<CellFace> faces;
  for (const CellComplex::Withdrawal::Region& region : withdrawal.regions) {
    cells.faces(region.restored, faces);
    // Slices that bound the region are not inserted there again.
    forget(bricks, [&](const Eigen::Vector3d& p, SliceId slice) {
      return std::all_of(faces.begin(), faces.end(), [&](const CellFace& face) {
        const double z = (face.image_to_reference->inverse() * p).z();
        return (face.above ? z : -z) > 0.0 && cells.slice_of(face.plane) != slice;
      });
    });
  }
}

/// Forgets the contours of which the middle and the slice are taken.
template <class Taken>
void ContourNews::forget(BrickPool& bricks, const Taken& taken) {
  std::erase_if(new_, [&](const Contour& c) { return taken(0.5 * (c.a + c.b), c.slice); });
  for (const std::uint32_t index : bricks.indices()) {
    WorkBrick& brick = bricks[index];
    const std::size_t gone = std::erase_if(brick.contours, [&](const ContourPiece& piece) {
      return taken(origin_mm_ + spacing_mm_ * middle(brick, piece), piece.slice);
    });
    if (gone == 0) continue;
    changed_.add(index);
    unseeded_.add(index);
    brick.contour_seeds = 0;
    for (const ContourPiece& piece : brick.contours) brick.contour_seeds |= octant_at(middle(brick, piece)).bit();
  }
}

void ContourNews::trace(BrickPool& bricks, OctantGrowth& growth) {
  std::uint32_t near = kNoBrick;
  for (const Contour& contour : new_) trace(contour, bricks, growth, near);
  for (const std::uint32_t index : unseeded_.items()) growth.unseed(index);
  sort_pieces(bricks);
  new_.clear();
  unseeded_.clear();
}

/// @param near  the brick where the contour before ended, kNoBrick; out, where this one does
void ContourNews::trace(const Contour& contour, BrickPool& bricks, OctantGrowth& growth, std::uint32_t& near) {
  const Eigen::Vector3d a = (contour.a - origin_mm_) / spacing_mm_, b = (contour.b - origin_mm_) / spacing_mm_;
  walk_grid(a / kOctantCells, b / kOctantCells, [&](double from, double to) {
    const Eigen::Vector3d p = a + from * (b - a), q = a + to * (b - a);
    const Octant octant = octant_at(0.5 * (p + q));
    if (near == kNoBrick || bricks[near].coord != octant.brick()) near = bricks.find_or_add(octant.brick());
    WorkBrick& brick = bricks[near];
    const Eigen::Vector3d base = first_sample(brick);
    brick.contours.push_back({(p - base).cast<float>(), (q - base).cast<float>(), contour.lower, contour.upper,
                              contour.slice, from == 0.0, to == 1.0});
    brick.contour_seeds |= octant.bit();
    growth.activate(near, octant.bit());
    changed_.add(near);
  });
}

/// Ascending by slice; those of one slice in an order that tells nothing of how they came.
void ContourNews::sort_pieces(BrickPool& bricks) const {
  const auto key = [](const ContourPiece& c) {
    return std::tuple(c.slice, c.a.x(), c.a.y(), c.a.z(), c.b.x(), c.b.y(), c.b.z(), c.lower, c.upper);
  };
  for (const std::uint32_t index : changed_.items())
    std::sort(bricks[index].contours.begin(), bricks[index].contours.end(),
              [&](const ContourPiece& l, const ContourPiece& r) { return key(l) < key(r); });
}

}  // namespace sonoloft
