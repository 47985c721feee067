#include "core/io/sequences/stack_formats.h"

namespace sonoloft {
namespace {

/// Takes the header's lines off the bytes, up to and with the empty one; the pixels remain. False where it does not
/// end. `field: value` and `key:=value` become the same.
bool take_fields(std::string_view& bytes, ImageStack& image) {
  while (true) {
    const std::size_t end = bytes.find('\n');
    if (end == std::string_view::npos) return false;
    const std::string_view line = trimmed(bytes.substr(0, end));
    bytes.remove_prefix(end + 1);
    if (line.empty()) return true;
    const std::size_t colon = line.find(':');
    if (line.starts_with('#') || colon == std::string_view::npos) continue;
    const std::size_t value = colon + (line.substr(colon).starts_with(":=") ? 2 : 1);
    image.fields.insert_or_assign(std::string(trimmed(line.substr(0, colon))),
                                  std::string(trimmed(line.substr(value))));
  }
}

}  // namespace

Result<ImageStack> parse_nrrd(std::string_view bytes, const std::string& name) {
  ImageStack image;
  if (!bytes.starts_with("NRRD"))
    return fail(ErrorCode::unsupported_format, name + ": does not begin with NRRD: not a .nrrd file");
  if (!take_fields(bytes, image))
    return fail(ErrorCode::parse_failed, name + ": the header does not end: the file is truncated");
  for (const char* key : {"data file", "datafile", "line skip", "lineskip", "byte skip", "byteskip"})
    if (image.fields.contains(std::string_view(key)))
      return fail(ErrorCode::unsupported_format,
                  name + ": its pixels are not right behind its header: save it as one .nrrd file");
  // Where images lie one after the other, the last direction counts them; colours would come before all others.
  const std::string_view kinds = image.field("kinds", "domain");
  if (!kinds.starts_with("domain") && !kinds.starts_with("space"))
    return fail(ErrorCode::unsupported_format,
                name + ": its kinds are " + std::string(kinds) + ": save grey images one after the other");
  if (auto read = read_dims(image.field("sizes"), name, image); !read) return tl::unexpected(read.error());
  const std::string_view encoding = image.field("encoding", "raw");
  const bool packed = encoding == "gzip" || encoding == "gz";
  if (!packed && encoding != "raw")
    return fail(ErrorCode::unsupported_format,
                name + ": encoding " + std::string(encoding) + " is not read: save it as raw or gzip");
  const PixelCoding coding{image.field("type"), image.field("endian") == "big" ? std::endian::big : std::endian::little,
                           packed};
  if (auto read = read_pixels(bytes, coding, name, image); !read) return tl::unexpected(read.error());
  return image;
}

}  // namespace sonoloft
