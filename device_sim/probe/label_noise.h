#pragma once
// What a segmentation gets wrong:  section -> [LABEL NOISE] -> simulated probe
#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "device_sim/probe/phantom.h"
#include "device_sim/probe/random.h"

namespace sonoloft::device_sim {

/// A smooth random displacement of the plane: one and the same for all contours that share a point. Sum of plane waves
/// whose directions have the spectrum of a Gaussian correlation; Rahimi and Recht 2007, "Random features".
class Displacement {
 public:
  /// @param rms_mm          length of the displacement
  /// @param correlation_mm  over this distance it stays much the same
  Displacement(double rms_mm, double correlation_mm, Random& random);
  [[nodiscard]] Eigen::Vector2d at(const Eigen::Vector2d& p) const;

 private:
  static constexpr int kWaves = 16;
  struct Wave {
    Eigen::Vector2d direction;  ///< radians per mm
    double phase_x, phase_y;
  };
  std::array<Wave, kWaves> waves_;
  double amplitude_mm_;
};

/// A section on which discs lie that say a wrong label: one that the section has elsewhere, outside among them. Their
/// middles are spread evenly over the view, their areas together are `share` of it; what is smaller than a disc and
/// lies in it stays. Nothing changes where the section has no label.
/// @param view   closed polygon, frame of the section
/// @pre   0 <= share <= 0.5
/// @cost  O(#points) for each disc
void add_wrong_discs(double share, double radius_mm, std::span<const Eigen::Vector2d> view, Random& random,
                     PhantomSection& section);

}  // namespace sonoloft::device_sim
