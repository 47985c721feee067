#pragma once
// What the verbs print, write and report in common.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "core/io/meshes/mesh_files.h"
#include "core/io/volumes/label_volume.h"
#include "core/mesh/mesh.h"
#include "core/slice/result.h"
#include "host/apps/picture/picture.h"

namespace sonoloft::tool {

struct Percentiles {
  double p50 = 0, p95 = 0, max = 0;
};
/// Nearest rank; all 0 of no values.
[[nodiscard]] Percentiles percentiles(std::vector<double> values);
[[nodiscard]] nlohmann::ordered_json json(const Percentiles& p);

/// Name and triangles of every label of a mesh, by its number.
[[nodiscard]] nlohmann::ordered_json labels_json(const IndexedMesh& mesh, const LabelTable& labels);
/// A line with its name for every label of a mesh.
[[nodiscard]] std::vector<LegendLine> legend_of(const IndexedMesh& mesh, const LabelTable& labels);

/// @error io_failed
[[nodiscard]] Result<void> write_report(const nlohmann::ordered_json& report, const std::filesystem::path& path);

/// Suffixes that write_mesh() knows.
inline constexpr const char* kMeshSuffixes = ".ply,.obj,.stl,.vtp";
/// Makes the folder where there is none. @pre the suffix is one of kMeshSuffixes @error io_failed
/// @param labels      STL does not take them
/// @param properties  only PLY takes them
[[nodiscard]] Result<void> write_mesh(const IndexedMesh& mesh, const std::filesystem::path& path,
                                      const LabelTable& labels, const VertexProperties& properties = {});

/// Suffixes that write_volume() knows.
inline constexpr const char* kVolumeSuffixes = ".seg.nrrd,.nii,.nii.gz";
/// Makes the folder where there is none. @pre the suffix is one of kVolumeSuffixes @error io_failed
[[nodiscard]] Result<void> write_volume(const LabelVolume& volume, const std::filesystem::path& path,
                                        const LabelTable& labels);

/// The mesh seen from outside, its largest of several labels as glass. Makes the folder where there is none.
/// @error those of draw() and write_png()
[[nodiscard]] Result<void> write_picture(const IndexedMesh& mesh, const LabelTable& labels,
                                         std::vector<LegendLine> legend, std::span<const Label> glass,
                                         const std::filesystem::path& path, int threads);

}  // namespace sonoloft::tool
