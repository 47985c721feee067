#include "core/octree/background_news.h"

namespace sonoloft {
namespace {

template <class Visit>
void for_each_between(const Eigen::Vector3i& first, const Eigen::Vector3i& last, Visit visit) {
  for (int z = first.z(); z <= last.z(); ++z)
    for (int y = first.y(); y <= last.y(); ++y)
      for (int x = first.x(); x <= last.x(); ++x) visit(x, y, z);
}

}  // namespace

void BackgroundNews::reach(const Eigen::AlignedBox3d& box_mm, int cells, Eigen::Vector3i& first,
                           Eigen::Vector3i& last) const {
  const double step_mm = cells * spacing_mm_;
  first = ((box_mm.min() - origin_mm_) / step_mm).array().floor().cast<int>();
  last = ((box_mm.max() - origin_mm_) / step_mm).array().floor().cast<int>();
}

void BackgroundNews::add(const Background& background, std::span<const BackgroundChange> changes) {
  lattice_origin_mm_ = background.cell_box({0, 0, 0}, 0).min();
  lattice_spacing_mm_ = background.spacing_mm();
  for (const BackgroundChange& change : changes) {
    changed_[{change.brick.x(), change.brick.y(), change.brick.z()}] |= change.changed;
    for (int bit = 0; bit < static_cast<int>(change.begun.size()); ++bit) {
      const auto b = static_cast<std::size_t>(bit);
      if (!change.begun[b] && !change.ended[b]) continue;
      Eigen::Vector3i first, last;
      reach(background.cell_box(change.brick, bit), kOctantCells, first, last);
      for_each_between(first, last, [&](int x, int y, int z) {
        const Octant octant{x, y, z};
        touched_.insert(octant);
        if (change.begun[b])
          ++cells_[octant];
        else if (--cells_[octant] == 0)
          cells_.erase(octant);
      });
    }
  }
}

void BackgroundNews::clear_changes() {
  changed_.clear();
  touched_.clear();
}

std::vector<BrickCoord> BackgroundNews::bricks() const {
  std::vector<BrickCoord> bricks;
  std::unordered_set<BrickCoord, BrickCoordHash> seen;
  for (const auto& [brick, mask] : changed_) {
    const Eigen::Vector3d low = lattice_origin_mm_ + lattice_spacing_mm_ * kBackgroundBrick *
                                                         Eigen::Vector3i(brick.x, brick.y, brick.z).cast<double>();
    Eigen::Vector3i first, last;
    reach({low, low + Eigen::Vector3d::Constant(lattice_spacing_mm_ * kBackgroundBrick)}, kBrickSize, first, last);
    for_each_between(first, last, [&](int x, int y, int z) {
      if (seen.insert({x, y, z}).second) bricks.push_back({x, y, z});
    });
  }
  return bricks;
}

bool BackgroundNews::changed(const Eigen::Vector3d& point_mm) const {
  const Eigen::Vector3i cell = ((point_mm - lattice_origin_mm_) / lattice_spacing_mm_).array().floor().cast<int>();
  const auto brick = changed_.find({cell.x() >> 3, cell.y() >> 3, cell.z() >> 3});
  if (brick == changed_.end()) return false;
  const Eigen::Vector3i at = cell - 8 * Eigen::Vector3i(cell.x() >> 3, cell.y() >> 3, cell.z() >> 3);
  return brick->second[static_cast<std::size_t>(at.x() + 8 * at.y() + 64 * at.z())];
}

}  // namespace sonoloft
