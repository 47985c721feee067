#pragma once
// What the formats of image stacks have in common.
#include <bit>
#include <string>
#include <string_view>

#include "core/io/sequences/image_stack.h"

namespace sonoloft {

/// How pixels lie in a file.
struct PixelCoding {
  std::string_view type;  ///< of both formats' names, e.g. MET_UCHAR, uint8
  std::endian order = std::endian::little;
  bool packed = false;  ///< zlib or gzip
};

// The formats that parse_image_stack() tells apart. Each is given the whole file, and its name for messages.
[[nodiscard]] Result<ImageStack> parse_meta_image(std::string_view bytes, const std::string& name);
[[nodiscard]] Result<ImageStack> parse_nrrd(std::string_view bytes, const std::string& name);

[[nodiscard]] std::string_view trimmed(std::string_view text);

/// Reads the sizes of a stack from numbers in a row; those between the second and the last must be 1.
/// @error parse_failed, too_large, unsupported_format (a fourth direction)
[[nodiscard]] Result<void> read_dims(std::string_view sizes, const std::string& name, ImageStack& image);

/// Fills in the pixels of a stack whose sizes are known. @error as the readers of stacks
[[nodiscard]] Result<void> read_pixels(std::string_view bytes, const PixelCoding& coding, const std::string& name,
                                       ImageStack& image);

}  // namespace sonoloft
