#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/io/sequences/image_stack.h"
#include "core/io/sequences/plus_config.h"

namespace sonoloft {

/// What of the images of a recording shows anything.
struct ImageView {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;  ///< pixels: a rectangle around it
  std::vector<Eigen::Vector2d> outline;               ///< pixels: along the outer edges of its pixels, convex
};

/// The images, or what of them the configuration clips. @return nothing where that is no pixel
[[nodiscard]] std::optional<ImageView> whole_view(const ImageStack& images, const std::optional<ClipRectangle>& clip);

/// The convex hull of what is not black in every image: the sector, or the strip, in images of a scanner.
/// @param view  what is looked at
/// @return nothing where all is black
/// @cost  O(pixels)
[[nodiscard]] std::optional<ImageView> lit_view(const ImageStack& images, const ImageView& view);

/// A part of one image.
struct GreyImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  ///< [height][width], x fastest

  [[nodiscard]] std::uint8_t at(std::uint32_t x, std::uint32_t y) const { return pixels[std::size_t{y} * width + x]; }
};

/// The rectangle of a view, of image `index`. @pre index < images.dims[2], the view lies in the images
[[nodiscard]] GreyImage crop(const ImageStack& images, std::size_t index, const ImageView& view);

}  // namespace sonoloft
