#pragma once
// What a recording was made with:  PLUS's configuration -> [PLUS CONFIG] -> transforms, clip rectangle
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/slice/result.h"

namespace sonoloft {

struct PlusTransform {
  std::string from, to;
  Eigen::Affine3d matrix;  ///< from -> to, mm; of an image: pixels
};

struct ClipRectangle {
  std::array<std::uint32_t, 2> origin, size;  ///< pixels: columns, rows
};

/// Of a configuration of the PLUS toolkit, what places and bounds images.
struct PlusConfig {
  std::vector<PlusTransform> transforms;  ///< CoordinateDefinitions
  std::optional<ClipRectangle> clip;      ///< ClipRectangleOrigin and -Size of VolumeReconstruction
};

/// Reads PLUS's configuration (.xml).
/// @error file_not_found, io_failed, too_large, unsupported_format (no XML, no PlusConfiguration), parse_failed (a
///        transform without From, To or a matrix), non_finite
/// Source: PLUS toolkit, "CoordinateDefinitions", "VolumeReconstruction".
[[nodiscard]] Result<PlusConfig> read_plus_config(const std::filesystem::path& path);

/// The same from text in memory; `name` is what messages call it.
[[nodiscard]] Result<PlusConfig> parse_plus_config(std::string_view text, std::string_view name);

}  // namespace sonoloft
