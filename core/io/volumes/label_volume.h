#pragma once
// Segmented volumes: what phantoms and tests are cut from, and what meshes are written as
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/slice/label.h"
#include "core/slice/result.h"

namespace sonoloft {

/// A label for every voxel of a box. Frame: the file's, mm.
struct LabelVolume {
  std::array<std::uint32_t, 3> dims{};                   ///< voxels along x, y, z
  Eigen::Vector3d spacing_mm = Eigen::Vector3d::Ones();  ///< between the centres of voxels
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();   ///< centre of voxel (0, 0, 0)
  std::vector<Label> labels;                             ///< [z][y][x], x fastest: dims[0] * dims[1] * dims[2]
};

inline constexpr std::uint32_t kMaxVolumeSide = 1u << 13;
inline constexpr std::uint64_t kMaxVolumeVoxels = 1ull << 29;

/// Reads an INRIMAGE-4 volume (.inr, or .inr.gz): one unsigned integer of 8 or 16 bits a voxel, either byte order.
/// @error file_not_found, io_failed, unsupported_format (another pixel type), parse_failed (header, truncated),
///        bad_contour (a label above kMaxLabel), too_large
/// @cost  O(#voxels); memory grows with the bytes that are really there, not with the declared size
[[nodiscard]] Result<LabelVolume> read_inr(const std::filesystem::path& path);

}  // namespace sonoloft
