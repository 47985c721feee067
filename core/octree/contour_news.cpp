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

/// A cell with the slices of its walls: these are still there.
class ContourNews::Region {
 public:
  Region(const CellComplex& cells, CellId cell) {
    std::vector<CellFace> faces;
    cells.faces(cell, faces);
    for (const CellFace& face : faces) {
      const Eigen::Vector3d inwards = (face.above ? 1 : -1) * face.image_to_reference->linear().col(2);
      walls_.push_back({inwards, -inwards.dot(face.image_to_reference->translation())});
      if (const auto slice = cells.slice_of(face.plane)) slices_.push_back(*slice);
    }
  }

  /// Whether a point of the contours of a slice lies in it, and not on a wall.
  [[nodiscard]] bool contains(const Eigen::Vector3d& point_mm, SliceId slice) const {
    return may_reach(point_mm, Eigen::Vector3d::Zero()) && std::ranges::find(slices_, slice) == slices_.end();
  }
  /// Whether it may reach into a box.
  [[nodiscard]] bool may_reach(const Eigen::Vector3d& centre_mm, const Eigen::Vector3d& half_mm) const {
    return std::ranges::all_of(walls_, [&](const Wall& wall) {
      return wall.inwards.dot(centre_mm) + wall.inwards.cwiseAbs().dot(half_mm) + wall.offset_mm > 0.0;
    });
  }

 private:
  struct Wall {
    Eigen::Vector3d inwards;
    double offset_mm;
  };
  std::vector<Wall> walls_;
  std::vector<SliceId> slices_;
};

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
  if (std::ranges::all_of(withdrawal.slices, [&](SliceId slice) { return cells.section(slice).edges.empty(); })) return;
  const std::vector<std::uint32_t> all = bricks.indices();
  for (const CellComplex::Withdrawal::Region& region : withdrawal.regions) {
    const Region of(cells, region.restored);
    std::erase_if(new_, [&](const Contour& c) { return of.contains(0.5 * (c.a + c.b), c.slice); });
    for (const std::uint32_t index : all) forget(of, bricks[index], index);
  }
}

/// Forgets the contours of a brick that run through a region.
void ContourNews::forget(const Region& region, WorkBrick& brick, std::uint32_t index) {
  if (brick.contours.empty()) return;
  const Eigen::Vector3d centre = first_sample(brick) + Eigen::Vector3d::Constant(0.5 * kBrickSize);
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.501 * kBrickSize);  // and what rounding may take
  if (!region.may_reach(origin_mm_ + spacing_mm_ * centre, spacing_mm_ * half)) return;
  const std::size_t gone = std::erase_if(brick.contours, [&](const ContourPiece& piece) {
    return region.contains(origin_mm_ + spacing_mm_ * middle(brick, piece), piece.slice);
  });
  if (gone == 0) return;
  changed_.add(index);
  unseeded_.add(index);
  brick.contour_seeds = 0;
  for (const ContourPiece& piece : brick.contours) brick.contour_seeds |= octant_at(middle(brick, piece)).bit();
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
