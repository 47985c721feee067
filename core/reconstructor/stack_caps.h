#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

namespace sonoloft {

/// Where an object ends beyond the first and the last slice of a stack, which do not say.
enum class Caps : std::uint8_t {
  gap,    ///< an empty plane one gap beyond: a flat end then closes about half way to it, which is the mean for slices
          ///< placed at random
  slice,  ///< at the slice itself
  box,    ///< the surface runs out towards the walls of the box
};

/// The frames of two empty planes beyond the ends of slices in parallel planes, that many gaps between the last two
/// slices away.
/// @param  frames    image to reference, mm
/// @param  gaps      >= 0
/// @param  least_mm  caps lie no nearer, since cells must have some width, and slices nearer to each other are taken
/// for
///                   one: half a finest cell will do; > 0
/// @return none when there are less than two slices, or when their planes lean against each other by more than 1
/// degree:
///         then they see the ends from the side
[[nodiscard]] std::vector<Eigen::Isometry3d> stack_caps(std::span<const Eigen::Isometry3d> frames, double gaps,
                                                        double least_mm);

}  // namespace sonoloft
