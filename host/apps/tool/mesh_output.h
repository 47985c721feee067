#pragma once
// Where the mesh goes:  mesh -> [MESH OUTPUT] -> mesh file, or label volume
#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>

#include "core/io/labels/label_table.h"
#include "core/mesh/mesh.h"
#include "core/slice/result.h"

namespace sonoloft::tool {

struct MeshOutput {
  std::filesystem::path path;      ///< its ending says as what
  std::optional<double> voxel_mm;  ///< of a label volume
};

/// --output, --voxel-mm
void add_mesh_output(CLI::App& verb, MeshOutput& output);

/// Makes the folder where there is none.
/// @param spacing_mm  edge of the finest cells; of the voxels, too, where nothing else was said
/// @error io_failed; those of voxelize(), and then the mesh is written all the same, as PLY
[[nodiscard]] Result<void> write_output(const IndexedMesh& mesh, const MeshOutput& output, const LabelTable& labels,
                                        double spacing_mm, int threads);

}  // namespace sonoloft::tool
