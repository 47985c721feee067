#pragma once
// For demonstration:  B-mode image -> [BONE] -> labels of its pixels
#include <Eigen/Core>
#include <vector>

#include "core/segmentation/image_view.h"
#include "core/slice/label.h"

namespace sonoloft {

inline constexpr Label kBone = 1;

/// Bone in a B-mode image, without any knowledge of anatomy: the one line across the columns that is the brightest
/// against all that lies below it, since bone gives a strong echo and nothing comes from beneath. From the line on 2 mm
/// are bone; deeper all is unknown, across the whole image; above is outside. Nothing found: all is unknown.
/// An image of a linear probe: columns run away from the transducer. To be looked at, not to be measured by.
/// @param mm_per_pixel  width and height of a pixel, > 0
/// @return [height][width], x fastest: outside, kBone or unknown
/// @cost  O(pixels * how steep the line may be); about 8 ms for 467 x 614
/// Source: shadows as in Foroughi et al. 2007, "Ultrasound bone segmentation using dynamic programming".
[[nodiscard]] std::vector<Label> segment_bone(const GreyImage& image, const Eigen::Vector2d& mm_per_pixel);

}  // namespace sonoloft
