#pragma once
// folder of slices and true meshes -> [BENCHMARK] -> a table, and its figures
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/field/field_method.h"
#include "core/slice/result.h"

namespace sonoloft::tool {

struct BenchmarkOptions {
  std::filesystem::path folder;  ///< NAME.csl or NAME.contour beside NAME.ply, .off, .obj or .stl, the first there is
  int depth;                     ///< the longest side of the contours is 2^depth / 1.1 finest cells long
  FieldMethod field;
  int threads;
};

/// Reconstructs every set of a folder and prints a line on each, by name, and the means; what cannot be evaluated gets
/// a line on the error stream, and the others go on. What is measured: docs/accuracy.md.
/// @return the same figures by the names of the sets, and how many sets failed
/// @error io_failed (no such folder), empty_input (no slices in it)
[[nodiscard]] Result<nlohmann::ordered_json> run_benchmark(const BenchmarkOptions& options);

}  // namespace sonoloft::tool
