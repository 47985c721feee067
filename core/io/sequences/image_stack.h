#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/slice/result.h"

namespace sonoloft {

/// Grey values: a volume, or images one after the other. Frame of a volume: the file's, mm.
struct ImageStack {
  std::array<std::uint32_t, 3> dims{};                     ///< columns, rows, and layers or images
  Eigen::Vector3d spacing_mm = Eigen::Vector3d::Ones();    ///< between the centres of voxels
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();     ///< centre of voxel (0, 0, 0)
  std::vector<std::uint8_t> pixels;                        ///< [z][y][x], x fastest; empty where dims has a 0
  std::map<std::string, std::string, std::less<>> fields;  ///< what the header says, without blanks at the ends

  /// A field of the header. @return otherwise: it does not say
  [[nodiscard]] std::string_view field(std::string_view key, std::string_view otherwise = "") const {
    const auto found = fields.find(key);
    return found == fields.end() ? otherwise : std::string_view(found->second);
  }
};

inline constexpr std::uint64_t kMaxStackPixels = 1ull << 30;

/// Reads a MetaImage (.mha) or an NRRD (.nrrd) with its pixels in the same file, packed or not, told apart by how it
/// begins. Spacing and origin of an NRRD are not read.
/// @error file_not_found, io_failed, unsupported_format (another kind of file, pixels in another file, no whole numbers
///        of 8 to 32 bits, a value that is not 0..255, colours), parse_failed (header; pixels truncated or damaged),
///        too_large
/// @cost  O(pixels); memory grows with the bytes that are really there, not with the declared size
/// Source: MetaIO's description of its format, teem's definition of NRRD.
[[nodiscard]] Result<ImageStack> read_image_stack(const std::filesystem::path& path);

/// The same from bytes in memory; `name` is what messages call it.
[[nodiscard]] Result<ImageStack> parse_image_stack(std::string_view bytes, std::string_view name);

}  // namespace sonoloft
