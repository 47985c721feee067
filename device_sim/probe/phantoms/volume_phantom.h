#pragma once
#include <Eigen/Geometry>
#include <span>

#include "device_sim/probe/phantom.h"
#include "device_sim/probe/phantoms/smooth_labels.h"

namespace sonoloft::device_sim {

/// A segmented image volume as a body with smooth borders. Each label's voxels are blurred in space with a Gaussian of
/// 3/4 of the coarsest voxel edge (or 7/3 of the finest where that is less), and a point has the label with the largest
/// share there: the stairs between voxels vanish, all planes see the one same body, and labels that touch keep
/// touching. Structures thinner than about two voxels lose volume or vanish. Frame: reference, mm.
class VolumePhantom final : public Phantom {
 public:
  /// @param dims       voxels along x, y, z
  /// @param origin_mm  centre of voxel (0, 0, 0)
  /// @param labels     [dims.x * dims.y * dims.z] x fastest; read only during the call
  /// @error dims not positive or not matching labels, over 2^31 voxels, a spacing or origin that is no (positive)
  ///        number, a label that is no material, no voxel with a label
  /// @cost  O(#voxels)
  [[nodiscard]] static Made<VolumePhantom> make(const Eigen::Vector3i& dims, const Eigen::Vector3d& spacing_mm,
                                                const Eigen::Vector3d& origin_mm, std::span<const Label> labels);

  [[nodiscard]] Eigen::AlignedBox3d bounds() const override { return bounds_; }
  /// @cost O(labels near the point)
  [[nodiscard]] Label label_at(const Eigen::Vector3d& point_mm) const override {
    return labels_.label_at((point_mm - origin_mm_).cwiseProduct(voxels_per_mm_));
  }
  /// @cost O((extent / grid_mm())^2)
  [[nodiscard]] PhantomSection section(const Eigen::Isometry3d& plane_to_reference) const override;
  /// @cost that of section() by the window's share of the plane
  [[nodiscard]] PhantomSection section_in(const Eigen::AlignedBox2d& window,
                                          const Eigen::Isometry3d& plane_to_reference) const override;
  /// The distance of the lines of the grid on which sections are traced: the geometric mean of a voxel's edges.
  [[nodiscard]] double grid_mm() const { return grid_mm_; }

 private:
  VolumePhantom() = default;

  Eigen::Vector3d origin_mm_, voxels_per_mm_;
  SmoothLabels labels_;
  Eigen::AlignedBox3d bounds_;
  double grid_mm_ = 0;
};

}  // namespace sonoloft::device_sim
