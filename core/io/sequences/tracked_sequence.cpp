#include "core/io/sequences/tracked_sequence.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>

#include "core/io/byte_file.h"
#include "core/io/sequences/matrix_text.h"
#include "core/io/text_scanner.h"

namespace sonoloft {
namespace {

constexpr std::string_view kTransform = "Transform", kStatus = "TransformStatus";
constexpr double kLongest_s = 9e9;  // what nanoseconds hold; times since 1970 are below 2e9

/// Fills one frame from the fields `Seq_FrameNNNN_...`.
class FrameReader {
 public:
  FrameReader(const ImageStack& image, std::string name) : image_(image), name_(std::move(name)) {}

  Result<SequenceFrame> read(std::size_t index) {
    char prefix[40];
    std::snprintf(prefix, sizeof prefix, "Seq_Frame%04zu_", index);
    prefix_ = prefix;
    SequenceFrame frame;
    const auto time = image_.fields.find(prefix_ + "Timestamp");
    if (time == image_.fields.end())
      return fail(ErrorCode::parse_failed, name_ + ": frame " + std::to_string(index) + " has no Timestamp: mend it");
    TextScanner digits(time->second, name_ + " " + time->first);
    const double seconds = digits.real("the time");
    if (digits.failed()) return digits.failure();
    if (std::abs(seconds) > kLongest_s)
      return fail(ErrorCode::parse_failed, name_ + " " + time->first + ": no time in seconds: mend it");
    frame.time = std::chrono::nanoseconds(std::llround(seconds * 1e9));
    const std::string_view status = image_.field(prefix_ + "ImageStatus", image_.field(prefix_ + "Status", "OK"));
    frame.image_ok = !image_.pixels.empty() && status == "OK";
    return read_transforms(frame);
  }

 private:
  Result<SequenceFrame> read_transforms(SequenceFrame& frame) {
    const auto& fields = image_.fields;
    for (auto it = fields.lower_bound(prefix_); it != fields.end() && it->first.starts_with(prefix_); ++it) {
      std::string_view key = std::string_view(it->first).substr(prefix_.size());
      if (!key.ends_with(kTransform)) continue;
      key.remove_suffix(kTransform.size());
      auto& transform = frame.transforms[std::string(key)];
      if (image_.field(prefix_ + std::string(key) + std::string(kStatus)) != "OK") continue;
      const auto matrix = parse_matrix(it->second, name_ + " " + it->first);
      if (!matrix) return tl::unexpected(matrix.error());
      transform = *matrix;
    }
    return frame;
  }

  const ImageStack& image_;
  std::string name_, prefix_;
};

/// Turns images round so that the first row is at the transducer and the first column at its mark.
Result<void> turn_round(const std::string& name, ImageStack& images) {
  const std::string_view orientation =
      images.field("UltrasoundImageOrientation", images.field("ultrasound image orientation", "MF"));
  const auto is = [&](std::size_t i, char one, char other) {
    return i < orientation.size() && (orientation[i] == one || orientation[i] == other);
  };
  if (!is(0, 'M', 'U') || !is(1, 'F', 'N'))
    return fail(ErrorCode::unsupported_format,
                name + ": its images lie as " + std::string(orientation) + ": save them as MF, a row for each depth");
  const std::span<std::uint8_t> pixels(images.pixels);
  const std::size_t width = images.dims[0], size = width * images.dims[1];
  if (orientation[0] == 'U')
    for (std::size_t row = 0; row < pixels.size(); row += width) std::ranges::reverse(pixels.subspan(row, width));
  if (orientation[1] == 'N')
    for (std::size_t image = 0; image < pixels.size(); image += size)
      for (std::size_t top = image, bottom = image + size - width; top < bottom; top += width, bottom -= width)
        std::ranges::swap_ranges(pixels.subspan(top, width), pixels.subspan(bottom, width));
  return {};
}

}  // namespace

Result<TrackedSequence> parse_tracked_sequence(std::string_view bytes, std::string_view text_name) {
  const std::string name(text_name);
  auto images = parse_image_stack(bytes, name);
  if (!images) return tl::unexpected(images.error());
  if (auto turned = turn_round(name, *images); !turned) return tl::unexpected(turned.error());
  TrackedSequence sequence;
  FrameReader reader(*images, name);
  for (std::size_t i = 0; i < images->dims[2]; ++i) {
    auto frame = reader.read(i);
    if (!frame) return tl::unexpected(frame.error());
    if (i > 0 && frame->time < sequence.frames.back().time)
      return fail(ErrorCode::parse_failed,
                  name + ": frame " + std::to_string(i) + " is older than the one before: sort the file");
    sequence.frames.push_back(std::move(*frame));
  }
  sequence.images = std::move(*images);
  return sequence;
}

Result<TrackedSequence> read_tracked_sequence(const std::filesystem::path& path) {
  const auto bytes = read_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_tracked_sequence(*bytes, path.filename().string());
}

}  // namespace sonoloft
