#pragma once
#include <CLI/CLI.hpp>

#include "core/mesh/mesh.h"
#include "core/reconstructor/reconstructor.h"
#include "core/slice/result.h"

namespace sonoloft::tool {

enum class Mesher {
  live,      ///< what a scan shows
  delaunay,  ///< core/offline, where it is built in
};
void add_mesher(CLI::App& verb, Mesher& mesher);

/// The surfaces of the last update.
/// @param delaunay_ms  out: time of the second mesher, 0 for the first
/// @error not_available (built without core/offline), those of delaunay_mesh()
[[nodiscard]] Result<IndexedMesh> surfaces(const Reconstructor& reconstructor, Mesher mesher, double& delaunay_ms);

}  // namespace sonoloft::tool
