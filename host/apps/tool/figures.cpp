#include "host/apps/tool/figures.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <string>
#include <system_error>
#include <utility>

#include "core/io/meshes/mesh_files.h"
#include "core/io/volumes/volume_files.h"

namespace sonoloft::tool {
namespace {

Result<void> make_folder_of(const std::filesystem::path& path) {
  if (!path.has_parent_path()) return {};
  std::error_code error;
  std::filesystem::create_directories(path.parent_path(), error);
  if (error)
    return fail(ErrorCode::io_failed, "the folder " + path.parent_path().string() +
                                          " cannot be made: " + error.message() + ": choose another place");
  return {};
}

/// The triangles that bound each label.
std::map<Label, std::size_t> triangles_of(const IndexedMesh& mesh) {
  std::map<Label, std::size_t> counts;
  for (const auto* side : {&mesh.label_front, &mesh.label_back})
    for (const Label label : *side) ++counts[label];
  counts.erase(kOutside);
  return counts;
}

}  // namespace

Percentiles percentiles(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto rank = [&](double share) {
    return values[static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size()))) - 1];
  };
  return {rank(0.5), rank(0.95), values.back()};
}

nlohmann::ordered_json json(const Percentiles& p) {
  return {{"p50", p.p50}, {"p95", p.p95}, {"max", p.max}};
}

nlohmann::ordered_json labels_json(const IndexedMesh& mesh, const LabelTable& labels) {
  nlohmann::ordered_json all = nlohmann::ordered_json::object();
  for (const auto& [label, triangles] : triangles_of(mesh))
    all[std::to_string(label)] = {{"name", labels.name(label)}, {"triangles", triangles}};
  return all;
}

std::vector<LegendLine> legend_of(const IndexedMesh& mesh, const LabelTable& labels) {
  std::vector<LegendLine> lines;
  for (const auto& [label, triangles] : triangles_of(mesh)) lines.push_back({label, labels.name(label)});
  return lines;
}

Result<void> write_report(const nlohmann::ordered_json& report, const std::filesystem::path& path) {
  if (auto made = make_folder_of(path); !made) return made;
  std::ofstream file(path);
  file << report.dump(2) << '\n';
  if (!file.flush()) return fail(ErrorCode::io_failed, path.string() + " cannot be written: choose another place");
  return {};
}

Result<void> write_mesh(const IndexedMesh& mesh, const std::filesystem::path& path, const LabelTable& labels,
                        const VertexProperties& properties) {
  if (auto made = make_folder_of(path); !made) return made;
  const auto suffix = path.extension();
  if (suffix == ".obj") return write_obj(mesh, path, labels);
  if (suffix == ".stl") return write_stl(mesh, path);
  if (suffix == ".vtp") return write_vtp(mesh, path, labels);
  return write_ply(mesh, path, labels, properties);
}

Result<void> write_volume(const LabelVolume& volume, const std::filesystem::path& path, const LabelTable& labels) {
  if (auto made = make_folder_of(path); !made) return made;
  return path.extension() == ".nrrd" ? write_seg_nrrd(volume, path, labels) : write_nifti(volume, path);
}

Result<void> write_picture(const IndexedMesh& mesh, const LabelTable& labels, std::vector<LegendLine> legend,
                           std::span<const Label> glass, const std::filesystem::path& path, int threads) {
  if (auto made = make_folder_of(path); !made) return made;
  PictureOptions options;
  options.labels = labels;
  options.legend = std::move(legend);
  options.transparent.assign(glass.begin(), glass.end());
  const auto picture = draw(mesh, options, threads);
  if (!picture) return tl::unexpected<Error>(picture.error());
  return write_png(*picture, path);
}

}  // namespace sonoloft::tool
