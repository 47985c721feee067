#include "core/segmentation/sequence_slices.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "core/segmentation/bone_segmentation.h"
#include "core/segmentation/image_view.h"
#include "core/slice/mask/label_mask.h"
#include "core/tracking/image_plane.h"
#include "core/tracking/transform_graph.h"

namespace sonoloft {
namespace {

std::vector<Label> segment(const GreyImage& image, const ImagePlane& plane, const SequenceReading& reading) {
  if (reading.meaning == PixelMeaning::bmode) return segment_bone(image, plane.mm_per_pixel.diagonal());
  std::vector<Label> labels(image.pixels.begin(), image.pixels.end());
  if (reading.unknown_value) std::ranges::replace(labels, Label{*reading.unknown_value}, kUnknown);
  return labels;
}

/// @param labels  of the view's rectangle
TrackedSlice slice_of(std::span<const Label> labels, const ImageView& view, const ImagePlane& plane) {
  TrackedSlice slice;
  slice.image_to_reference = plane.image_to_reference;
  MaskContours regions = trace_mask({static_cast<int>(view.width), static_cast<int>(view.height), labels});
  slice.contours = std::move(regions.contours);
  const Eigen::Vector2d corner(view.x, view.y);
  for (const Eigen::Vector2d& p : regions.points) slice.points.emplace_back(plane.mm_per_pixel * (corner + p));
  for (const Eigen::Vector2d& p : view.outline) slice.field_of_view.emplace_back(plane.mm_per_pixel * p);
  return slice;
}

Result<ImageView> view_of(const TrackedSequence& sequence, const PlusConfig& config, PixelMeaning meaning) {
  auto view = whole_view(sequence.images, config.clip);
  if (!view)
    return fail(ErrorCode::empty_input, "there is no pixel in the clip rectangle, or in the images: check both");
  if (meaning == PixelMeaning::bmode) view = lit_view(sequence.images, *view);
  if (!view) return fail(ErrorCode::empty_input, "all images are black: record others");
  return *view;
}

}  // namespace

PixelMeaning guess_meaning(const ImageStack& images) {
  constexpr std::ptrdiff_t kMostLabels = 64;
  std::array<bool, 256> seen{};
  for (const std::uint8_t value : images.pixels) seen[value] = true;
  return std::ranges::count(seen, true) <= kMostLabels ? PixelMeaning::labels : PixelMeaning::bmode;
}

Result<SequenceSlices> slices_of(const TrackedSequence& sequence, const PlusConfig& config,
                                 const SequenceReading& reading) {
  TransformGraph fixed, all;
  fixed.set(config);
  all = fixed;
  for (const SequenceFrame& frame : sequence.frames) all.set(frame);
  if (auto connected = all.check_connected(reading.image, reading.reference); !connected)
    return tl::unexpected(connected.error());
  const auto view = view_of(sequence, config, reading.meaning);
  if (!view) return tl::unexpected(view.error());

  SequenceSlices result;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    const SequenceFrame& frame = sequence.frames[i];
    TransformGraph graph = fixed;
    graph.set(frame);
    const auto pixels_to_reference = graph.find(reading.image, reading.reference);
    result.without_image += frame.image_ok ? 0 : 1;
    result.without_pose += frame.image_ok && !pixels_to_reference ? 1 : 0;
    if (!frame.image_ok || !pixels_to_reference) continue;
    const auto plane = image_plane(*pixels_to_reference);
    if (!plane)
      return fail(ErrorCode::not_rigid, "frame " + std::to_string(i) + ": " + reading.image + " has no area in " +
                                            reading.reference + ": mend the calibration");
    result.slices.push_back(slice_of(segment(crop(sequence.images, i, *view), *plane, reading), *view, *plane));
    result.slices.back().id = i;
    result.slices.back().time = frame.time;
  }
  if (result.slices.empty())
    return fail(ErrorCode::empty_input, "no frame has both an image and a pose with status OK: record again");
  return result;
}

}  // namespace sonoloft
