#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "device_sim/probe/phantom.h"

namespace sonoloft::device_sim {

/// A section that somebody took, with the pose it was taken at.
struct RecordedPlane {
  Eigen::Isometry3d plane_to_reference = Eigen::Isometry3d::Identity();
  PhantomSection section;
};

/// Recorded sections played back: there is something to see in the recorded planes only.
class RecordedPlanes final : public SectionSource {
 public:
  /// @error no plane, no loop at all, loops that do not fit their points, numbers that are none
  [[nodiscard]] static Made<RecordedPlanes> make(std::vector<RecordedPlane> planes);

  [[nodiscard]] Eigen::AlignedBox3d bounds() const override { return bounds_; }
  /// The recorded section of this very plane (to 1e-6 of bounds() and 1e-6 rad), moved into the asked plane's frame;
  /// empty for any other plane. @cost O(#planes + #points)
  [[nodiscard]] PhantomSection section(const Eigen::Isometry3d& plane_to_reference) const override;
  /// The trajectory that visits every plane once, in order.
  [[nodiscard]] std::vector<Eigen::Isometry3d> trajectory() const;

 private:
  RecordedPlanes() = default;

  std::vector<RecordedPlane> planes_;
  Eigen::AlignedBox3d bounds_;
};

}  // namespace sonoloft::device_sim
