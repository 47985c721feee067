#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "core/slice/result.h"

namespace sonoloft {

/// Larger files are not read into memory.
inline constexpr std::uint64_t kMaxFileBytes = 1ull << 31;

/// @error file_not_found, io_failed, too_large
[[nodiscard]] Result<std::string> read_bytes(const std::filesystem::path& path);

/// Replaces the file. @error io_failed
[[nodiscard]] Result<void> write_bytes(const std::filesystem::path& path, std::string_view bytes);

}  // namespace sonoloft
