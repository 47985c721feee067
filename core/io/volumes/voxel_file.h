#pragma once
#include <filesystem>
#include <span>
#include <string_view>

#include "core/slice/label.h"
#include "core/slice/result.h"

namespace sonoloft {

/// What of a file of voxels is packed (gzip).
enum class Packed { nothing, voxels, all };

/// Replaces the file by a header and the labels behind it, 16 bits, little-endian. @error io_failed
[[nodiscard]] Result<void> write_voxel_file(const std::filesystem::path& path, std::string_view header,
                                            std::span<const Label> labels, Packed packed);

}  // namespace sonoloft
