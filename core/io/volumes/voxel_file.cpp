#include "core/io/volumes/voxel_file.h"

#include <zlib.h>

#include <algorithm>
#include <bit>

#include "core/io/byte_file.h"

namespace sonoloft {
namespace {

static_assert(std::endian::native == std::endian::little, "labels are written as they lie in memory");

bool put(gzFile file, std::span<const char> bytes) {
  constexpr std::size_t kPiece = 1 << 20;
  for (; !bytes.empty(); bytes = bytes.subspan(std::min(kPiece, bytes.size()))) {
    const auto count = static_cast<unsigned>(std::min(kPiece, bytes.size()));
    if (gzwrite(file, bytes.data(), count) != static_cast<int>(count)) return false;
  }
  return true;
}

}  // namespace

Result<void> write_voxel_file(const std::filesystem::path& path, std::string_view header, std::span<const Label> labels,
                              Packed packed) {
  const bool header_apart = packed == Packed::voxels;
  if (header_apart)
    if (auto written = write_bytes(path, header); !written) return written;
  // Few, long runs of labels: more effort packs them hardly better.
  const gzFile file = gzopen(path.c_str(), packed == Packed::nothing ? "wbT" : header_apart ? "ab1" : "wb1");
  bool good = file != nullptr;
  if (good && !header_apart) good = put(file, header);
  if (good) good = put(file, {reinterpret_cast<const char*>(labels.data()), labels.size_bytes()});
  if (file != nullptr) good = gzclose(file) == Z_OK && good;
  if (!good)
    return fail(ErrorCode::io_failed, path.string() + ": cannot be written: check the folder and the space left");
  return {};
}

}  // namespace sonoloft
