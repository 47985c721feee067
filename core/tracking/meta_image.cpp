#include "core/tracking/meta_image.h"

#include <zlib.h>

#include <algorithm>

#include "core/io/byte_file.h"
#include "core/io/text_scanner.h"

namespace sonoloft {
namespace {

constexpr std::string_view kDataKey = "ElementDataFile";

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// Takes the header's lines off the bytes; the pixels remain. False where it does not end.
bool take_fields(std::string_view& bytes, MetaImage& image) {
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

std::string_view field(const MetaImage& image, std::string_view key, std::string_view otherwise) {
  const auto found = image.fields.find(key);
  return found == image.fields.end() ? otherwise : std::string_view(found->second);
}

Result<void> read_geometry(MetaImage& image, const std::string& name) {
  TextScanner dims(field(image, "DimSize", ""), name + " DimSize");
  for (std::uint32_t& dim : image.dims) dim = static_cast<std::uint32_t>(dims.whole("a size", UINT32_MAX));
  if (dims.failed()) return dims.failure();
  TextScanner spacing(field(image, "ElementSpacing", "1 1 1"), name + " ElementSpacing");
  image.spacing_mm = spacing.vector("a spacing");
  if (spacing.failed()) return spacing.failure();
  TextScanner origin(field(image, "Offset", "0 0 0"), name + " Offset");
  image.origin_mm = origin.vector("an offset");
  if (origin.failed()) return origin.failure();
  if ((image.spacing_mm.array() <= 0).any())
    return fail(ErrorCode::parse_failed, name + ": ElementSpacing is not positive: mend the header");
  return {};
}

Result<std::size_t> pixel_count(const MetaImage& image, const std::string& name) {
  std::uint64_t count = 1;
  for (const std::uint32_t dim : image.dims) {
    if (dim != 0 && count > kMaxMetaPixels / dim)
      return fail(ErrorCode::too_large, name + ": over 2^30 pixels: split the file");
    count *= dim;
  }
  return static_cast<std::size_t>(count);
}

/// Unpacks until `count` bytes are there or the stream ends.
std::vector<std::uint8_t> unpack(std::string_view packed, std::size_t count) {
  constexpr std::size_t kPiece = 1 << 20;
  std::vector<std::uint8_t> pixels;
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return pixels;
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(std::min<std::size_t>(packed.size(), UINT32_MAX));
  int state = Z_OK;
  while (state == Z_OK && pixels.size() < count) {
    const std::size_t before = pixels.size(), wanted = std::min(kPiece, count - before);
    pixels.resize(before + wanted);
    stream.next_out = pixels.data() + before;
    stream.avail_out = static_cast<uInt>(wanted);
    state = inflate(&stream, Z_NO_FLUSH);
    pixels.resize(before + wanted - stream.avail_out);
  }
  inflateEnd(&stream);
  return pixels;
}

}  // namespace

Result<MetaImage> parse_meta_image(std::string_view bytes, std::string_view text_name) {
  const std::string name(text_name);
  MetaImage image;
  if (!bytes.starts_with("ObjectType") && !bytes.starts_with("NDims"))
    return fail(ErrorCode::unsupported_format, name + ": does not begin like a MetaImage header: not a .mha file");
  if (!take_fields(bytes, image))
    return fail(ErrorCode::parse_failed, name + ": the header does not end: the file is truncated");
  if (field(image, kDataKey, "") != "LOCAL")
    return fail(ErrorCode::unsupported_format, name + ": its pixels are in another file: convert it to .mha");
  if (field(image, "ElementType", "") != "MET_UCHAR" || field(image, "ElementNumberOfChannels", "1") != "1" ||
      field(image, "NDims", "") != "3")
    return fail(ErrorCode::unsupported_format, name + ": not one byte a pixel in three dimensions: convert it");
  if (const auto read = read_geometry(image, name); !read) return tl::unexpected(read.error());
  const auto count = pixel_count(image, name);
  if (!count) return tl::unexpected(count.error());
  if (field(image, "CompressedData", "False") == "True") {
    image.pixels = unpack(bytes, *count);
  } else {
    image.pixels.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(std::min(bytes.size(), *count)));
  }
  if (image.pixels.size() != *count)
    return fail(ErrorCode::parse_failed, name + ": the file ends within the pixels: it is truncated or damaged");
  return image;
}

Result<MetaImage> read_meta_image(const std::filesystem::path& path) {
  const auto bytes = read_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_meta_image(*bytes, path.filename().string());
}

}  // namespace sonoloft
