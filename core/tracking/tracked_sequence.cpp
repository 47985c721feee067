#include "core/tracking/tracked_sequence.h"

#include <cmath>
#include <cstdio>

#include "core/io/byte_file.h"
#include "core/io/text_scanner.h"

namespace sonoloft {
namespace {

constexpr std::string_view kTransform = "Transform", kStatus = "TransformStatus";
constexpr double kRigidTolerance = 1e-2;  // files state six digits

/// Files round their numbers: the nearest rotation stands for what was measured.
std::optional<Eigen::Isometry3d> rigid(const Eigen::Matrix4d& matrix) {
  const Eigen::Matrix3d axes = matrix.topLeftCorner<3, 3>();
  const double off = (axes.transpose() * axes - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off < kRigidTolerance) || axes.determinant() < 0) return std::nullopt;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(axes).normalized().toRotationMatrix();
  pose.translation() = matrix.topRightCorner<3, 1>();
  return pose;
}

/// Fills one frame from the fields `Seq_FrameNNNN_...`.
class FrameReader {
 public:
  FrameReader(const MetaImage& image, std::string name) : fields_(image.fields), name_(std::move(name)) {}

  Result<SequenceFrame> read(std::size_t index) {
    char prefix[40];
    std::snprintf(prefix, sizeof prefix, "Seq_Frame%04zu_", index);
    prefix_ = prefix;
    SequenceFrame frame;
    const auto time = fields_.find(prefix_ + "Timestamp");
    if (time == fields_.end())
      return fail(ErrorCode::parse_failed, name_ + ": frame " + std::to_string(index) + " has no Timestamp: mend it");
    TextScanner digits(time->second, name_ + " " + time->first);
    const double seconds = digits.real("the time");
    if (digits.failed()) return digits.failure();
    if (std::abs(seconds) > 1e9)
      return fail(ErrorCode::parse_failed, name_ + " " + time->first + ": no time in seconds: mend it");
    frame.time = std::chrono::nanoseconds(std::llround(seconds * 1e9));
    const auto image = fields_.find(prefix_ + "ImageStatus");
    frame.image_ok = image != fields_.end() && image->second == "OK";
    return read_transforms(frame);
  }

 private:
  Result<SequenceFrame> read_transforms(SequenceFrame& frame) {
    for (auto it = fields_.lower_bound(prefix_); it != fields_.end() && it->first.starts_with(prefix_); ++it) {
      std::string_view key = std::string_view(it->first).substr(prefix_.size());
      if (!key.ends_with(kTransform)) continue;
      key.remove_suffix(kTransform.size());
      const auto status = fields_.find(prefix_ + std::string(key) + std::string(kStatus));
      auto& pose = frame.transforms[std::string(key)];
      if (status == fields_.end() || status->second != "OK") continue;
      TextScanner numbers(it->second, name_ + " " + it->first);
      Eigen::Matrix4d matrix;
      for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = numbers.real("a number of the matrix");
      if (numbers.failed()) return numbers.failure();
      pose = rigid(matrix);
      if (!pose) return fail(ErrorCode::not_rigid, name_ + " " + it->first + ": no rotation and translation: mend it");
    }
    return frame;
  }

  const std::map<std::string, std::string, std::less<>>& fields_;
  std::string name_, prefix_;
};

}  // namespace

Result<TrackedSequence> parse_tracked_sequence(std::string_view bytes, std::string_view text_name) {
  const std::string name(text_name);
  auto image = parse_meta_image(bytes, name);
  if (!image) return tl::unexpected(image.error());
  TrackedSequence sequence;
  FrameReader reader(*image, name);
  for (std::size_t i = 0; i < image->dims[2]; ++i) {
    auto frame = reader.read(i);
    if (!frame) return tl::unexpected(frame.error());
    if (i > 0 && frame->time < sequence.frames.back().time)
      return fail(ErrorCode::parse_failed,
                  name + ": frame " + std::to_string(i) + " is older than the one before: " + "sort the file");
    sequence.frames.push_back(std::move(*frame));
  }
  sequence.images = std::move(*image);
  return sequence;
}

Result<TrackedSequence> read_tracked_sequence(const std::filesystem::path& path) {
  const auto bytes = read_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_tracked_sequence(*bytes, path.filename().string());
}

std::optional<Eigen::Isometry3d> transform_between(const SequenceFrame& frame, std::string_view from,
                                                   std::string_view to) {
  const auto a = frame.transforms.find(std::string(from) + "ToTracker");
  const auto b = frame.transforms.find(std::string(to) + "ToTracker");
  if (a == frame.transforms.end() || b == frame.transforms.end() || !a->second || !b->second) return std::nullopt;
  return b->second->inverse() * *a->second;
}

}  // namespace sonoloft
