#pragma once
// Recorded images and poses:  .igs.mha, .igs.nrrd -> [TRACKED SEQUENCE] -> slices; poses at the images' times
#include <Eigen/Geometry>
#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/sequences/image_stack.h"
#include "core/slice/result.h"

namespace sonoloft {

/// One entry of a recording: an image, poses, or both.
struct SequenceFrame {
  std::chrono::nanoseconds time{0};  ///< the recording's clock
  bool image_ok = false;             ///< there is one, and no status says otherwise
  /// By name as in the file, "ProbeToTracker"; mm, to the file's digits. Nothing where its status is not OK.
  std::map<std::string, std::optional<Eigen::Affine3d>, std::less<>> transforms;
};

/// A recording of tracked ultrasound as PLUS and 3D Slicer write it (sequence metafile, or the same as NRRD).
struct TrackedSequence {
  /// dims[2] images, one for each frame; without pixels where only poses were recorded. As PLUS holds them: the first
  /// row is at the transducer, the first column at its mark ("MF"), however they lie in the file.
  ImageStack images;
  std::vector<SequenceFrame> frames;
};

/// Reads a sequence (.igs.mha, .igs.nrrd).
/// @post  frames.size() == images.dims[2], times do not decrease
/// @error those of read_image_stack(); unsupported_format (images that are turned by 90 degrees), parse_failed (a frame
///        without a time, a transform that is no 16 numbers of an affine map, times that run backwards)
/// @cost  O(bytes)
/// Source: PLUS toolkit, "Sequence metafile"; IGSIO, "NRRD sequence".
[[nodiscard]] Result<TrackedSequence> read_tracked_sequence(const std::filesystem::path& path);

/// The same from bytes in memory; `name` is what messages call it.
[[nodiscard]] Result<TrackedSequence> parse_tracked_sequence(std::string_view bytes, std::string_view name);

}  // namespace sonoloft
