#include "core/io/volumes/label_volume.h"

#include <zlib.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>

#include "core/io/byte_order.h"
#include "core/io/text_scanner.h"

namespace sonoloft {
namespace {

constexpr std::size_t kHeaderBlock = 256, kMaxHeader = 64 * kHeaderBlock;

/// A file, unpacked while it is read where it is packed.
class PackedFile {
 public:
  explicit PackedFile(const std::filesystem::path& path) : file_(gzopen(path.c_str(), "rb"), gzclose) {}
  bool is_open() const { return file_ != nullptr; }

  /// Appends up to `count` bytes; fewer at the end of the file or where it is damaged.
  void read(std::string& bytes, std::size_t count) {
    constexpr std::size_t kPiece = 1 << 20;
    while (count > 0) {
      const std::size_t before = bytes.size(), wanted = std::min(count, kPiece);
      bytes.resize(before + wanted);
      const int got = gzread(file_.get(), bytes.data() + before, static_cast<unsigned>(wanted));
      bytes.resize(before + static_cast<std::size_t>(std::max(got, 0)));
      if (got <= 0) return;
      count -= static_cast<std::size_t>(got);
    }
  }

 private:
  std::unique_ptr<gzFile_s, int (*)(gzFile)> file_;
};

struct Header {
  std::array<std::uint32_t, 3> dims{};
  Eigen::Vector3d spacing = Eigen::Vector3d::Ones(), origin = Eigen::Vector3d::Zero();
  std::size_t voxel_bytes = 0;
  std::endian order = std::endian::little;
};

/// `KEY=value` lines.
std::map<std::string, std::string, std::less<>> header_values(std::string_view text) {
  std::map<std::string, std::string, std::less<>> values;
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    const std::size_t equals = line.find('=');
    if (equals != std::string_view::npos && !line.starts_with('#'))
      values.emplace(line.substr(0, equals), line.substr(equals + 1));
  }
  return values;
}

Result<Header> parse_header(std::string_view text, const std::string& name) {
  const auto values = header_values(text);
  const auto value = [&](std::string_view key, std::string_view otherwise) {
    const auto found = values.find(key);
    return found == values.end() ? std::string(otherwise) : found->second;
  };
  Header header;
  for (const std::size_t k : {0u, 1u, 2u}) {
    const std::string axis(1, "XYZ"[k]);
    const auto number = [&](const std::string& key, std::string_view otherwise) {
      const std::string digits = value(key, otherwise);
      TextScanner in(digits, name + " " + key);
      const double result = in.real("the value");
      return in.failed() ? std::numeric_limits<double>::quiet_NaN() : result;
    };
    const double dim = number(axis + "DIM", "0");
    const auto axis_index = static_cast<Eigen::Index>(k);
    header.spacing[axis_index] = number("V" + axis, "1");
    header.origin[axis_index] = number("T" + axis, "0");
    if (!(dim >= 1) || dim != std::floor(dim) || !(header.spacing[axis_index] > 0) ||
        std::isnan(header.origin[axis_index]))
      return fail(ErrorCode::parse_failed, name + ": the header's " + axis + "DIM, V" + axis + " or T" + axis +
                                               " is missing or no size: mend the header");
    if (dim > kMaxVolumeSide)
      return fail(ErrorCode::too_large,
                  name + ": over " + std::to_string(kMaxVolumeSide) + " voxels along " + axis + ": crop the volume");
    header.dims[k] = static_cast<std::uint32_t>(dim);
  }
  const std::string type = value("TYPE", ""), bits = value("PIXSIZE", ""), scalars = value("VDIM", "1");
  if (type != "unsigned fixed" || (!bits.starts_with("8 bit") && !bits.starts_with("16 bit")) || scalars != "1")
    return fail(ErrorCode::unsupported_format,
                name + ": voxels are not one unsigned integer of 8 or 16 bits: convert it");
  header.voxel_bytes = bits.starts_with("8") ? 1 : 2;
  const std::string cpu = value("CPU", "decm");
  header.order = cpu == "sun" || cpu == "sgi" ? std::endian::big : std::endian::little;
  return header;
}

/// Headers end with `##}` at a multiple of 256 bytes.
Result<Header> read_header(PackedFile& file, const std::string& name) {
  std::string text;
  while (text.size() < kMaxHeader) {
    const std::size_t before = text.size();
    file.read(text, kHeaderBlock);
    if (before == 0 && !text.starts_with("#INRIMAGE-4#"))
      return fail(ErrorCode::unsupported_format, name + ": does not begin with #INRIMAGE-4#: not an INRIMAGE file");
    if (text.size() < before + kHeaderBlock) break;
    if (text.find("##}") != std::string::npos) return parse_header(text, name);
  }
  return fail(ErrorCode::parse_failed, name + ": the header does not end: the file is truncated");
}

}  // namespace

Result<LabelVolume> read_inr(const std::filesystem::path& path) {
  std::error_code error;
  const std::string name = path.filename().string();
  if (!std::filesystem::exists(path, error))
    return fail(ErrorCode::file_not_found, path.string() + ": there is no such file: check the path");
  PackedFile file(path);
  if (!file.is_open() || std::filesystem::is_directory(path, error))
    return fail(ErrorCode::io_failed, path.string() + ": cannot be read: name a readable file");
  const auto header = read_header(file, name);
  if (!header) return tl::unexpected(header.error());
  const std::uint64_t voxels = std::uint64_t{header->dims[0]} * header->dims[1] * header->dims[2];
  if (voxels > kMaxVolumeVoxels) return fail(ErrorCode::too_large, name + ": over 2^29 voxels: crop the volume");

  std::string bytes;
  file.read(bytes, static_cast<std::size_t>(voxels) * header->voxel_bytes);
  if (bytes.size() != voxels * header->voxel_bytes)
    return fail(ErrorCode::parse_failed, name + ": the file ends within the voxels: it is truncated or damaged");
  LabelVolume volume{header->dims, header->spacing, header->origin, {}};
  volume.labels.resize(static_cast<std::size_t>(voxels));
  for (std::size_t i = 0; i < volume.labels.size(); ++i)
    volume.labels[i] = header->voxel_bytes == 1 ? static_cast<std::uint8_t>(bytes[i])
                                                : load<std::uint16_t>(bytes, 2 * i, header->order);
  if (std::any_of(volume.labels.begin(), volume.labels.end(), [](Label l) { return l > kMaxLabel; }))
    return fail(ErrorCode::bad_contour, name + ": a voxel has a reserved label: use 0 to 65520");
  return volume;
}

}  // namespace sonoloft
