#include "core/io/byte_file.h"

#include <fstream>

namespace sonoloft {

Result<std::string> read_bytes(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    return fail(ErrorCode::file_not_found, path.string() + ": there is no such file: check the path");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return fail(ErrorCode::io_failed, path.string() + ": " + error.message() + ": name a regular file");
  if (size > kMaxFileBytes) return fail(ErrorCode::too_large, path.string() + ": over 2 GiB: split the file");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file.read(bytes.data(), static_cast<std::streamsize>(size)))
    return fail(ErrorCode::io_failed, path.string() + ": cannot be read: check its permissions");
  return bytes;
}

Result<void> write_bytes(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file.flush())
    return fail(ErrorCode::io_failed, path.string() + ": cannot be written: check the folder and the space left");
  return {};
}

}  // namespace sonoloft
