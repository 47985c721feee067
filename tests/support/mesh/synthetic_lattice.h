#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/octree/brick.h"

namespace sonoloft::test {

/// The shares of labels 0..n-1 at a lattice point.
using ShareField = std::function<void(Eigen::Vector3i point, std::span<float> shares)>;

/// Samples of an analytic field on lattice points 0..size in each axis, kept as the octree keeps them: only where a
/// surface is near, and outside (label 0) all over the border.
class SyntheticLattice final : public SampleLattice {
 public:
  SyntheticLattice(int size, int labels, const ShareField& field,
                   const Eigen::Vector3d& origin_mm = Eigen::Vector3d::Zero(), double spacing_mm = 1);

  [[nodiscard]] const Brick* find(BrickCoord coord) const override;
  [[nodiscard]] std::span<const ContourPiece> contours(BrickCoord) const override { return {}; }
  [[nodiscard]] Eigen::Vector3d origin_mm() const override { return origin_mm_; }
  [[nodiscard]] double spacing_mm() const override { return spacing_mm_; }

  /// Replaces the field at the points lower..upper (both included) and samples again.
  /// @return bricks with a cell of which a corner changed, appeared or vanished, ascending
  std::vector<BrickCoord> edit(Eigen::Vector3i lower, Eigen::Vector3i upper, const ShareField& field);

  /// All bricks, ascending.
  [[nodiscard]] std::vector<BrickCoord> bricks() const;

 private:
  using Bricks = std::unordered_map<BrickCoord, Brick, BrickCoordHash>;

  [[nodiscard]] std::size_t index(Eigen::Vector3i p) const;
  void fill(Eigen::Vector3i lower, Eigen::Vector3i upper, const ShareField& field);
  [[nodiscard]] std::vector<char> near_surface() const;
  [[nodiscard]] Bricks sample() const;
  [[nodiscard]] Brick make_brick(BrickCoord coord, const std::vector<Eigen::Vector3i>& points) const;

  int size_, labels_;
  Eigen::Vector3d origin_mm_;
  double spacing_mm_;
  std::vector<float> share_;  ///< [points][labels]
  std::vector<Label> label_;  ///< [points]
  Bricks bricks_;
};

/// Fields for tests. Lengths in lattice steps; shares of labels that do not reach a brick are 0 and not in its palette.
[[nodiscard]] ShareField sphere_field(Eigen::Vector3d centre, double radius);
/// Label i + 1 inside of sphere i; where spheres overlap, the one that reaches deeper.
[[nodiscard]] ShareField spheres_field(std::vector<std::pair<Eigen::Vector3d, double>> spheres);
/// Independent noise for each label, averaged over a box of (2 * smoothing + 1)^3 points. Any points, no size.
[[nodiscard]] ShareField noise_field(std::uint64_t seed, int smoothing);
/// A sum of plane waves 8 to 20 steps long for each label: smooth surfaces, folds and triple lines everywhere.
[[nodiscard]] ShareField waves_field(std::uint64_t seed);

}  // namespace sonoloft::test
