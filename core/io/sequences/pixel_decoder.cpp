
#include <zlib.h>

#include <algorithm>

#include "core/io/byte_order.h"
#include "core/io/sequences/stack_formats.h"
#include "core/io/text_scanner.h"

namespace sonoloft {
namespace {

struct Type {
  std::string_view names;  ///< apart by blanks, and around them
  std::size_t size;
  std::int64_t (*load)(std::string_view bytes, std::size_t offset, std::endian order);
};

template <class T>
std::int64_t load_as(std::string_view bytes, std::size_t offset, std::endian order) {
  return load<T>(bytes, offset, order);
}

constexpr Type kTypes[] = {
    {" MET_UCHAR uchar uint8 uint8_t unsigned_char ", 1, load_as<std::uint8_t>},
    {" MET_CHAR signed_char int8 int8_t ", 1, load_as<std::int8_t>},
    {" MET_SHORT short int16 int16_t short_int signed_short ", 2, load_as<std::int16_t>},
    {" MET_USHORT ushort uint16 uint16_t unsigned_short ", 2, load_as<std::uint16_t>},
    {" MET_INT int int32 int32_t signed_int ", 4, load_as<std::int32_t>},
    {" MET_UINT uint uint32 uint32_t unsigned_int ", 4, load_as<std::uint32_t>},
};

const Type* type_of(std::string_view name) {
  std::string wanted(name);
  std::replace(wanted.begin(), wanted.end(), ' ', '_');
  wanted = ' ' + wanted + ' ';
  const auto* found = std::find_if(std::begin(kTypes), std::end(kTypes),
                                   [&](const Type& t) { return t.names.find(wanted) != t.names.npos; });
  return found == std::end(kTypes) ? nullptr : found;
}

/// Unpacks until `count` bytes are there or the stream ends.
std::string unpack(std::string_view packed, std::size_t count) {
  constexpr std::size_t kPiece = 1 << 20;
  constexpr int kZlibOrGzip = 32 + MAX_WBITS;
  std::string bytes;
  z_stream stream{};
  if (inflateInit2(&stream, kZlibOrGzip) != Z_OK) return bytes;
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(std::min<std::size_t>(packed.size(), UINT32_MAX));
  int state = Z_OK;
  while (state == Z_OK && bytes.size() < count) {
    const std::size_t before = bytes.size(), wanted = std::min(kPiece, count - before);
    bytes.resize(before + wanted);
    stream.next_out = reinterpret_cast<Bytef*>(bytes.data() + before);
    stream.avail_out = static_cast<uInt>(wanted);
    state = inflate(&stream, Z_NO_FLUSH);
    bytes.resize(before + wanted - stream.avail_out);
  }
  inflateEnd(&stream);
  return bytes;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

Result<void> read_dims(std::string_view sizes, const std::string& name, ImageStack& image) {
  TextScanner in(sizes, name + " sizes");
  std::vector<std::uint32_t> dims;
  while (!in.failed() && !in.at_end()) dims.push_back(static_cast<std::uint32_t>(in.whole("a size", UINT32_MAX)));
  if (in.failed()) return in.failure();
  // A recording of poses alone may state images of 0 x 0 x 0.
  const bool flat = dims.size() == 4 && (dims[2] == 1 || dims[0] == 0);
  if (dims.size() != 3 && !flat)
    return fail(ErrorCode::unsupported_format, name + ": not in three dimensions, or four of which the third is 1");
  image.dims = {dims[0], dims[1], dims.back()};
  std::uint64_t count = 1;
  for (const std::uint32_t dim : image.dims) {
    if (dim != 0 && count > kMaxStackPixels / dim)
      return fail(ErrorCode::too_large, name + ": over 2^30 pixels: split the file");
    count *= dim;
  }
  return {};
}

Result<void> read_pixels(std::string_view bytes, const PixelCoding& coding, const std::string& name,
                         ImageStack& image) {
  const std::size_t count = std::size_t{image.dims[0]} * image.dims[1] * image.dims[2];
  if (count == 0) return {};
  const Type* type = type_of(coding.type);
  if (type == nullptr)
    return fail(ErrorCode::unsupported_format, name + ": its pixels are " + std::string(coding.type) +
                                                   ", not whole numbers of 8 to 32 bits: convert it");
  const std::string unpacked = coding.packed ? unpack(bytes, count * type->size) : std::string();
  if (coding.packed) bytes = unpacked;
  if (bytes.size() < count * type->size)
    return fail(ErrorCode::parse_failed, name + ": the file ends within the pixels: it is truncated or damaged");
  image.pixels.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t value = type->load(bytes, i * type->size, coding.order);
    if (value < 0 || value > UINT8_MAX)
      return fail(ErrorCode::unsupported_format,
                  name + ": a pixel of value " + std::to_string(value) + ": values of 0 to 255 are read, convert it");
    image.pixels[i] = static_cast<std::uint8_t>(value);
  }
  return {};
}

}  // namespace sonoloft
