#include "core/io/sequences/stack_formats.h"
#include "core/io/text_scanner.h"

namespace sonoloft {
namespace {

constexpr std::string_view kDataKey = "ElementDataFile";

/// Takes the header's lines off the bytes; the pixels remain. False where it does not end.
bool take_fields(std::string_view& bytes, ImageStack& image) {
  while (true) {
    const std::size_t end = bytes.find('\n');
    if (end == std::string_view::npos) return false;
    const std::string_view line = bytes.substr(0, end);
    bytes.remove_prefix(end + 1);
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) return false;
    const std::string_view key = trimmed(line.substr(0, equals));
    image.fields.insert_or_assign(std::string(key), std::string(trimmed(line.substr(equals + 1))));
    if (key == kDataKey) return true;
  }
}

Result<void> read_geometry(const std::string& name, ImageStack& image) {
  if (auto read = read_dims(image.field("DimSize"), name, image); !read) return read;
  TextScanner spacing(image.field("ElementSpacing", "1 1 1"), name + " ElementSpacing");
  image.spacing_mm = spacing.vector("a spacing");
  if (spacing.failed()) return spacing.failure();
  TextScanner origin(image.field("Offset", "0 0 0"), name + " Offset");
  image.origin_mm = origin.vector("an offset");
  if (origin.failed()) return origin.failure();
  if ((image.spacing_mm.array() <= 0).any())
    return fail(ErrorCode::parse_failed, name + ": ElementSpacing is not positive: mend the header");
  return {};
}

}  // namespace

Result<ImageStack> parse_meta_image(std::string_view bytes, const std::string& name) {
  ImageStack image;
  if (!bytes.starts_with("ObjectType") && !bytes.starts_with("NDims"))
    return fail(ErrorCode::unsupported_format,
                name + ": does not begin like a MetaImage header: neither a .mha nor a .nrrd file");
  if (!take_fields(bytes, image))
    return fail(ErrorCode::parse_failed, name + ": the header does not end: the file is truncated");
  if (image.field(kDataKey) != "LOCAL")
    return fail(ErrorCode::unsupported_format, name + ": its pixels are in another file: convert it to .mha");
  if (image.field("ElementNumberOfChannels", "1") != "1")
    return fail(ErrorCode::unsupported_format, name + ": its pixels are colours: convert them to grey values");
  if (auto read = read_geometry(name, image); !read) return tl::unexpected(read.error());
  const bool big_endian = image.field("BinaryDataByteOrderMSB", image.field("ElementByteOrderMSB")) == "True";
  const PixelCoding coding{image.field("ElementType"), big_endian ? std::endian::big : std::endian::little,
                           image.field("CompressedData") == "True"};
  if (auto read = read_pixels(bytes, coding, name, image); !read) return tl::unexpected(read.error());
  return image;
}

}  // namespace sonoloft
