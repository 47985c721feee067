#include "host/apps/tool/slice_input.h"

#include <iostream>
#include <string>
#include <utility>

#include "core/io/slices/slice_files.h"
#include "host/apps/tool/common_options.h"

namespace sonoloft::tool {
namespace {

Result<LoadedSlices> load_sequence(const SliceInput& input) {
  const auto sequence = read_tracked_sequence(input.path);
  if (!sequence) return tl::unexpected<Error>(sequence.error());
  const auto config = input.config ? read_plus_config(*input.config) : PlusConfig();
  if (!config) return tl::unexpected<Error>(config.error());
  SequenceReading reading = input.reading;
  reading.meaning = input.meaning.value_or(guess_meaning(sequence->images));
  auto read = slices_of(*sequence, *config, reading);
  if (!read) return tl::unexpected<Error>(read.error());
  const bool bmode = reading.meaning == PixelMeaning::bmode;
  std::cout << sequence->frames.size() << " images of " << (bmode ? "brightness, bone is looked for" : "labels")
            << "; without a good image " << read->without_image << ", without a good pose " << read->without_pose
            << '\n';
  return LoadedSlices{std::move(read->slices),
                      {{"in_file", sequence->frames.size()},
                       {"pixels", bmode ? "bmode" : "labels"},
                       {"without_image", read->without_image},
                       {"without_pose", read->without_pose}}};
}

}  // namespace

void add_slice_input(CLI::App& verb, SliceInput& input) {
  verb.add_option("input", input.path,
                  "Recorded slices: .csl or .contour; or tracked images of PLUS and 3D Slicer: .igs.mha or .igs.nrrd")
      ->required()
      ->check(ends_in(".csl,.contour,.mha,.nrrd"));
  verb.add_option("--config", input.config, "Of tracked images: PLUS's configuration, with ImageToProbe (.xml)");
  verb.add_option_function<std::string>(
          "--pixels",
          [&input](const std::string& name) {
            input.meaning = name == "labels" ? PixelMeaning::labels : PixelMeaning::bmode;
          },
          "Of tracked images: what pixels are: labels, or bmode (brightness, in which bone is looked for, for "
          "demonstration); default: labels where there are up to 64 values")
      ->check(CLI::IsMember({"labels", "bmode"}));
  verb.add_option("--unknown-value", input.reading.unknown_value, "Of label images: the value of what was not seen")
      ->check(CLI::Range(0, 255));
  verb.add_option("--image", input.reading.image, "Of tracked images: what transforms call the image")
      ->capture_default_str();
  verb.add_option("--reference", input.reading.reference, "Of tracked images: what transforms call the mesh's frame")
      ->capture_default_str();
}

Result<LoadedSlices> load_slices(const SliceInput& input) {
  const auto suffix = input.path.extension();
  if (suffix == ".mha" || suffix == ".nrrd") return load_sequence(input);
  auto file = suffix == ".contour" ? read_contour(input.path) : read_csl(input.path);
  if (!file) return tl::unexpected<Error>(file.error());
  return LoadedSlices{std::move(file->slices), nullptr};
}

}  // namespace sonoloft::tool
