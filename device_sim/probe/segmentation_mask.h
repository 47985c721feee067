#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/slice.h"

namespace sonoloft::device_sim {

/// A label for every pixel of a grid, as run lengths: what a network that segments images gives.
struct SegmentationMask {
  protocol::MaskGrid grid;
  std::vector<protocol::MaskRun> runs;
};

/// Paints contours into pixels by the rule of protocol/slice.h: the smallest contour around a pixel's centre says its
/// label. The grid lies around the field of view or, without one, around the contours and an eighth of them; its longer
/// side has `pixels`.
/// @pre  pixels >= 1; contours as a slice may have them
/// @cost O(pixels^2 + rows that each edge crosses)
[[nodiscard]] SegmentationMask paint_mask(std::span<const protocol::Point> points,
                                          std::span<const protocol::Contour> contours,
                                          std::span<const protocol::Point> field_of_view, std::uint16_t pixels);

}  // namespace sonoloft::device_sim
