#include "core/io/sequences/image_stack.h"

#include "core/io/byte_file.h"
#include "core/io/sequences/stack_formats.h"

namespace sonoloft {

Result<ImageStack> parse_image_stack(std::string_view bytes, std::string_view name) {
  return bytes.starts_with("NRRD") ? parse_nrrd(bytes, std::string(name)) : parse_meta_image(bytes, std::string(name));
}

Result<ImageStack> read_image_stack(const std::filesystem::path& path) {
  const auto bytes = read_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_image_stack(*bytes, path.filename().string());
}

}  // namespace sonoloft
