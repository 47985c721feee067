#pragma once
// Recorded images and poses:  .igs.mha -> [TRACKED SEQUENCE] -> poses at the images' times
#include <Eigen/Geometry>
#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/slice/result.h"
#include "core/tracking/meta_image.h"

namespace sonoloft {

/// One entry of a recording: an image, poses, or both.
struct SequenceFrame {
  std::chrono::nanoseconds time{0};  ///< the recording's clock
  bool image_ok = false;
  /// By name as in the file, "ProbeToTracker". Rigid to the file's digits, mm. Nothing where its status is not OK.
  std::map<std::string, std::optional<Eigen::Isometry3d>, std::less<>> transforms;
};

/// A recording of tracked ultrasound as PLUS writes it (sequence metafile).
struct TrackedSequence {
  MetaImage images;  ///< dims[2] images, one for each frame; without pixels where only poses were recorded
  std::vector<SequenceFrame> frames;
};

/// Reads a sequence metafile (.igs.mha, .seq.mha).
/// @post  frames.size() == images.dims[2], times do not decrease
/// @error those of read_meta_image(); parse_failed (a frame without a time, a transform that is no 16 numbers, times
///        that run backwards), not_rigid (a transform with status OK whose axes are off by more than 1 %)
/// @cost  O(bytes)
[[nodiscard]] Result<TrackedSequence> read_tracked_sequence(const std::filesystem::path& path);

/// The same from bytes in memory; `name` is what messages call it.
[[nodiscard]] Result<TrackedSequence> parse_tracked_sequence(std::string_view bytes, std::string_view name);

/// Where `from` is in `to`, by way of what both are measured in ("Tracker"): inv(ToToTracker) * FromToTracker.
/// Nothing where either is missing or not ok.
[[nodiscard]] std::optional<Eigen::Isometry3d> transform_between(const SequenceFrame& frame, std::string_view from,
                                                                 std::string_view to);

}  // namespace sonoloft
