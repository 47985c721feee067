#include "host/apps/tool/mesh_output.h"

#include <string>

#include "core/voxels/voxelize.h"
#include "host/apps/tool/common_options.h"
#include "host/apps/tool/figures.h"

namespace sonoloft::tool {

void add_mesh_output(CLI::App& verb, MeshOutput& output) {
  const std::string suffixes = std::string(kMeshSuffixes) + ',' + kVolumeSuffixes;
  verb.add_option("-o,--output", output.path, "Mesh or label volume to write: " + suffixes)
      ->required()
      ->check(ends_in(suffixes));
  const CLI::Validator of_volume(
      [&output](std::string&) -> std::string {
        std::string path = output.path.string();
        return ends_in(kVolumeSuffixes)(path).empty() ? "" : "is for label volumes: " + std::string(kVolumeSuffixes);
      },
      {});
  verb.add_option("--voxel-mm", output.voxel_mm, "Edge of a label volume's voxels; default: that of the finest cells")
      ->check(finite(1e-6, 1e6))
      ->check(of_volume);
}

Result<void> write_output(const IndexedMesh& mesh, const MeshOutput& output, const LabelTable& labels,
                          double spacing_mm, int threads) {
  std::string path = output.path.string();
  if (!ends_in(kVolumeSuffixes)(path).empty()) return write_mesh(mesh, output.path, labels);
  const auto volume = voxelize(mesh, output.voxel_mm.value_or(spacing_mm), threads);
  if (volume) return write_volume(*volume, output.path, labels);
  // A scan cannot be had again.
  Error error = volume.error();
  const std::string instead = path + ".ply";
  if (write_mesh(mesh, instead, labels)) error.message += "; the mesh is in " + instead;
  return tl::unexpected<Error>(error);
}

}  // namespace sonoloft::tool
