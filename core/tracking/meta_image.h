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

/// A MetaImage file of grey values: a volume, or images one after the other. Frame of a volume: the file's, mm.
struct MetaImage {
  std::array<std::uint32_t, 3> dims{};                     ///< columns, rows, and layers or images
  Eigen::Vector3d spacing_mm = Eigen::Vector3d::Ones();    ///< between the centres of voxels
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();     ///< centre of voxel (0, 0, 0)
  std::vector<std::uint8_t> pixels;                        ///< [z][y][x], x fastest; empty where dims has a 0
  std::map<std::string, std::string, std::less<>> fields;  ///< all `key = value` lines, without blanks at the ends
};

inline constexpr std::uint64_t kMaxMetaPixels = 1ull << 30;

/// Reads a MetaImage file with its pixels in the same file, packed or not.
/// @error file_not_found, io_failed, unsupported_format (no MetaImage, pixels in another file, not one byte a pixel),
///        parse_failed (header; pixels truncated or damaged), too_large
/// @cost  O(pixels); memory grows with the bytes that are really there, not with the declared size
[[nodiscard]] Result<MetaImage> read_meta_image(const std::filesystem::path& path);

/// The same from bytes in memory; `name` is what messages call it.
[[nodiscard]] Result<MetaImage> parse_meta_image(std::string_view bytes, std::string_view name);

}  // namespace sonoloft
