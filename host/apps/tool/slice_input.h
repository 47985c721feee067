#pragma once
// Where recorded slices come from:  slice file, or sequence of images -> [SLICE INPUT] -> slices
#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "core/segmentation/sequence_slices.h"
#include "core/slice/result.h"
#include "core/slice/tracked_slice.h"

namespace sonoloft::tool {

struct SliceInput {
  std::filesystem::path path;  ///< its ending says what it is
  std::optional<std::filesystem::path> config;
  std::optional<PixelMeaning> meaning;  ///< guessed where nothing is said
  SequenceReading reading;              ///< its meaning is not used
};

/// input, and for sequences --config, --pixels, --unknown-value, --image, --reference
void add_slice_input(CLI::App& verb, SliceInput& input);

struct LoadedSlices {
  std::vector<TrackedSlice> slices;
  nlohmann::ordered_json frames;  ///< of a sequence: what became of them; else null
};

/// Says how a sequence was understood. @error those of the readers and of slices_of()
[[nodiscard]] Result<LoadedSlices> load_slices(const SliceInput& input);

}  // namespace sonoloft::tool
