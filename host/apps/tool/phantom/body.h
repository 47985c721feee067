#pragma once
// What a simulated probe scans:  name or file -> [BODY] -> section source, truth
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/io/volumes/label_volume.h"
#include "core/mesh/mesh.h"
#include "core/slice/result.h"
#include "device_sim/simulator/simulated_device.h"
#include "host/apps/measure/measure.h"

namespace sonoloft::tool {

/// What a mesh is measured against. Nothing where only recorded slices are known.
using Truth = std::variant<std::monostate, LabelVolume, IndexedMesh>;

struct Body : device_sim::Subject {
  Truth truth;
};

/// A body by its name (liver, femur, organs, torso) or out of a file: recorded slices (.csl, .contour), a closed mesh
/// (.off, .stl, .ply, .obj), voxels (.inr, .inr.gz). Organs and torso are formulas: their truth are voxels cut
/// from them.
/// @param data  where the demo's data are; see find_data()
/// @error file_not_found, unsupported_format, and those of the readers and phantoms
[[nodiscard]] Result<Body> load_body(const std::string& name_or_file, const std::optional<std::filesystem::path>& data);

/// A file of the demo's data: in `data`, else in the folder that SONOLOFT_DATA names, else in build/data; there as it
/// is, in images/ or in meshes/. @error file_not_found
[[nodiscard]] Result<std::filesystem::path> find_data(const std::string& file,
                                                      const std::optional<std::filesystem::path>& data);

/// A mesh or voxels out of a file. @error those of read_mesh(), read_inr()
[[nodiscard]] Result<Truth> load_truth(const std::filesystem::path& file);

/// Grey values as labels: 1 for the value with the most voxels, and so on; values of fewer than 8 voxels are noise and
/// become outside. @return the grey value of each label, from label 1 on
std::vector<Label> number_by_volume(LabelVolume& volume);

/// @pre truth is not nothing @error those of measure_against_mesh() and measure_against_volume()
[[nodiscard]] Result<Comparison> compare(const IndexedMesh& mesh, const Truth& truth, int threads);

}  // namespace sonoloft::tool
