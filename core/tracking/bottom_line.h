#pragma once
#include <optional>
#include <vector>

#include "core/io/sequences/image_stack.h"

namespace sonoloft {

/// How deep the brightest line across each image lies, in rows: what the flat bottom of a water tank looks like. The
/// median over the middle columns, so that speckle and the line's slant do not move it; nothing for an image in which
/// the columns do not agree on a line.
/// @cost O(pixels)
[[nodiscard]] std::vector<std::optional<double>> bottom_lines(const ImageStack& images);

}  // namespace sonoloft
