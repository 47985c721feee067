#pragma once
// Recorded images into slices:  TrackedSequence, PlusConfig -> [SEQUENCE SLICES] -> TrackedSlice
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/io/sequences/plus_config.h"
#include "core/io/sequences/tracked_sequence.h"
#include "core/slice/result.h"
#include "core/slice/tracked_slice.h"

namespace sonoloft {

/// What the pixels of a recording are.
enum class PixelMeaning : std::uint8_t {
  labels,  ///< each its label, 0 is outside
  bmode,   ///< brightness: bone is looked for, see segment_bone()
};

/// Label images have few values, brightness has many: up to 64 different ones are labels. @cost O(pixels)
[[nodiscard]] PixelMeaning guess_meaning(const ImageStack& images);

struct SequenceReading {
  std::string image = "Image", reference = "Reference";  ///< what the transforms call both
  PixelMeaning meaning = PixelMeaning::labels;
  std::optional<std::uint8_t> unknown_value;  ///< of a label image: what was not seen
};

struct SequenceSlices {
  std::vector<TrackedSlice> slices;  ///< id: the frame's number
  std::size_t without_image = 0;     ///< frames without a good image
  std::size_t without_pose = 0;      ///< frames with one that no good transforms place
};

/// The slices of a recording: each good image is placed by the transforms of its frame and of the configuration,
/// whatever chain of them leads from the image to the reference, and its regions are traced. Field of view: the
/// configuration's clip rectangle, else the image; of B-mode, what in there is not black in every image.
/// @error invalid_argument (no transforms join image and reference), empty_input (no good image that is placed; all
///        pixels clipped or black), not_rigid (the transforms make no plane of an image)
/// @cost  O(pixels)
[[nodiscard]] Result<SequenceSlices> slices_of(const TrackedSequence& sequence, const PlusConfig& config,
                                               const SequenceReading& reading);

}  // namespace sonoloft
