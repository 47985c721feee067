#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "core/background/background.h"
#include "core/octree/bricks/octants.h"

namespace sonoloft {

/// What became of the background since the samples were last renewed, in octants and samples.
class BackgroundNews {
 public:
  BackgroundNews(const Eigen::Vector3d& origin_mm, double spacing_mm)
      : origin_mm_(origin_mm), spacing_mm_(spacing_mm) {}

  void add(const Background& background, std::span<const BackgroundChange> changes);
  void clear_changes();

  /// Where the background's own surfaces run now, or ran when the samples were last renewed.
  [[nodiscard]] const std::unordered_set<Octant, OctantHash>& octants() const { return touched_; }
  [[nodiscard]] bool seeds(const Octant& octant) const { return cells_.contains(octant); }

  /// Bricks with samples whose background may have changed, each once.
  [[nodiscard]] std::vector<BrickCoord> bricks() const;
  [[nodiscard]] bool changed(const Eigen::Vector3d& point_mm) const;

 private:
  /// The octants that a box reaches, (bricks: the bricks): lowest and highest.
  void reach(const Eigen::AlignedBox3d& box_mm, int cells, Eigen::Vector3i& first, Eigen::Vector3i& last) const;

  Eigen::Vector3d origin_mm_;
  double spacing_mm_;
  Eigen::Vector3d lattice_origin_mm_ = Eigen::Vector3d::Zero();
  double lattice_spacing_mm_ = 1;
  std::unordered_map<BrickCoord, BackgroundMask, BrickCoordHash> changed_;  ///< by brick of the background's lattice
  std::unordered_map<Octant, std::uint32_t, OctantHash> cells_;  ///< how many of the background's seeds reach an octant
  std::unordered_set<Octant, OctantHash> touched_;
};

}  // namespace sonoloft
