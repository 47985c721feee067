#include <cstdio>
#include <memory>
#include <optional>

#include "core/tracking/bottom_line.h"
#include "core/tracking/time_offset.h"
#include "core/tracking/transform_graph.h"
#include "host/apps/tool/common_options.h"
#include "host/apps/tool/figures.h"
#include "host/apps/tool/verbs/verbs.h"

namespace sonoloft::tool {
namespace {

struct CalibrateTimeOptions {
  std::filesystem::path images;
  std::optional<std::filesystem::path> poses;  ///< where they are not with the images
  std::string probe = "Probe", reference = "Reference";
  std::optional<std::filesystem::path> report;
};

Result<PoseTrack> track_of(const TrackedSequence& poses, const CalibrateTimeOptions& options) {
  PoseTrack track;
  bool any = false;
  for (const SequenceFrame& frame : poses.frames) {
    auto pose = transform_between(frame, options.probe, options.reference);
    any |= pose.has_value();
    track.add(frame.time, std::move(pose));
  }
  if (any) return track;
  return fail(ErrorCode::empty_input, "there is no usable pose of " + options.probe + " in " + options.reference +
                                          ": name both with --probe and --reference, and the file with --poses");
}

Result<void> run_calibrate_time(const CalibrateTimeOptions& options) {
  const auto images = read_tracked_sequence(options.images);
  if (!images) return tl::unexpected<Error>(images.error());
  const auto poses = options.poses ? read_tracked_sequence(*options.poses) : images;
  if (!poses) return tl::unexpected<Error>(poses.error());
  const auto track = track_of(*poses, options);
  if (!track) return tl::unexpected<Error>(track.error());

  const auto lines = bottom_lines(images->images);
  std::vector<TimedValue> seen;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i] && images->frames[i].image_ok) seen.push_back({images->frames[i].time, *lines[i]});
  }
  const auto found = estimate_time_offset(seen, *track);
  if (!found) return tl::unexpected<Error>(found.error());
  const double offset_ms = static_cast<double>(found->offset.count()) * 1e-6;
  std::printf("%zu images, a line in %zu of them\n", lines.size(), seen.size());
  std::printf("offset %.1f ms: an image belongs to the pose of its time %+.1f ms (correlation %.4f)\n", offset_ms,
              offset_ms, found->correlation);
  if (!options.report) return {};
  return write_report({{"offset_ms", offset_ms},
                       {"correlation", found->correlation},
                       {"images", lines.size()},
                       {"images_with_a_line", seen.size()}},
                      *options.report);
}

}  // namespace

void add_calibrate_time(CLI::App& app, Task& task) {
  auto* verb = app.add_subcommand(
      "calibrate-time",
      "Measures how far apart the times of images and poses are, from a recording over a flat bottom");
  auto options = std::make_shared<CalibrateTimeOptions>();
  verb->add_option("images", options->images, "Recording of a probe moved up and down over a water tank: .igs.mha")
      ->required();
  verb->add_option("--poses", options->poses, "Recording of the poses, where they are not with the images");
  verb->add_option("--probe", options->probe, "What the tracker calls the probe")->capture_default_str();
  verb->add_option("--reference", options->reference, "What the tracker calls the fixed reference")
      ->capture_default_str();
  add_report(*verb, options->report);
  verb->callback([&task, options] { task = [options] { return run_calibrate_time(*options); }; });
}

}  // namespace sonoloft::tool
