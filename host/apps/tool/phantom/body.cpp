#include "host/apps/tool/phantom/body.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>
#include <vector>

#include "core/io/meshes/mesh_files.h"
#include "core/io/slices/slice_files.h"
#include "device_sim/probe/phantoms/mesh_phantom.h"
#include "device_sim/probe/phantoms/recorded_planes.h"
#include "device_sim/probe/phantoms/solid_phantom.h"
#include "device_sim/probe/phantoms/torso_phantom.h"
#include "device_sim/probe/phantoms/volume_phantom.h"

namespace sonoloft::tool {
namespace {

constexpr std::size_t kNoiseVoxels = 8;
constexpr double kTruthVoxelsAlongBody = 200;

template <class T>
Result<Body> body_of(device_sim::Made<T> made, Truth truth, const std::filesystem::path& file) {
  if (!made.value) return fail(ErrorCode::invalid_argument, file.string() + ": " + made.error);
  Body body;
  body.source = std::move(made.value);
  body.truth = std::move(truth);
  return body;
}

Result<Body> volume_body(LabelVolume volume, const std::filesystem::path& file) {
  const Eigen::Vector3i dims(static_cast<int>(volume.dims[0]), static_cast<int>(volume.dims[1]),
                             static_cast<int>(volume.dims[2]));
  auto made = device_sim::VolumePhantom::make(dims, volume.spacing_mm, volume.origin_mm, volume.labels);
  return body_of(std::move(made), std::move(volume), file);
}

Result<Body> mesh_body(IndexedMesh mesh, const std::filesystem::path& file) {
  std::vector<Eigen::Vector3d> positions;
  for (const Eigen::Vector3f& p : mesh.positions) positions.push_back(p.cast<double>());
  auto made = device_sim::MeshPhantom::make(std::move(positions), mesh.triangles, 1);
  return body_of(std::move(made), std::move(mesh), file);
}

/// The labels at the middles of voxels all over a phantom.
LabelVolume voxels_of(const device_sim::Phantom& phantom) {
  LabelVolume volume;
  const Eigen::AlignedBox3d bounds = phantom.bounds();
  const double edge_mm = bounds.sizes().maxCoeff() / kTruthVoxelsAlongBody;
  volume.spacing_mm.setConstant(edge_mm);
  volume.origin_mm = bounds.min().array() + edge_mm / 2;
  for (int axis = 0; axis < 3; ++axis)
    volume.dims[static_cast<std::size_t>(axis)] = static_cast<std::uint32_t>(std::ceil(bounds.sizes()[axis] / edge_mm));
  for (std::uint32_t z = 0; z < volume.dims[2]; ++z)
    for (std::uint32_t y = 0; y < volume.dims[1]; ++y)
      for (std::uint32_t x = 0; x < volume.dims[0]; ++x)
        volume.labels.push_back(phantom.label_at(volume.origin_mm + edge_mm * Eigen::Vector3d(x, y, z)));
  return volume;
}

Body solid_body(device_sim::SolidPhantom phantom, std::vector<Label> bones) {
  Body body;
  body.truth = voxels_of(phantom);
  body.source = std::make_shared<device_sim::SolidPhantom>(std::move(phantom));
  body.bones = std::move(bones);
  return body;
}

device_sim::RecordedPlane recorded_plane(const TrackedSlice& slice) {
  device_sim::RecordedPlane plane;
  plane.plane_to_reference = slice.image_to_reference;
  for (const Contour& contour : slice.contours) {  // a phantom's loops follow each other without a gap
    const auto first = static_cast<std::uint32_t>(plane.section.points.size());
    plane.section.loops.push_back({first, contour.count, contour.hole ? kOutside : contour.label, contour.hole});
    const auto begin = slice.points.begin() + contour.first;
    plane.section.points.insert(plane.section.points.end(), begin, begin + contour.count);
  }
  plane.section.field_of_view = slice.field_of_view;
  return plane;
}

Result<Body> recorded_body(const std::filesystem::path& path) {
  const auto file = path.extension() == ".csl" ? read_csl(path) : read_contour(path);
  if (!file) return tl::unexpected<Error>(file.error());
  Body body;
  std::vector<device_sim::RecordedPlane> planes;
  for (const TrackedSlice& slice : file->slices) {
    planes.push_back(recorded_plane(slice));
    body.max_points = std::max({body.max_points, static_cast<std::uint32_t>(slice.points.size()),
                                static_cast<std::uint32_t>(slice.field_of_view.size())});
    body.max_contours = std::max(body.max_contours, static_cast<std::uint32_t>(slice.contours.size()));
  }
  auto made = device_sim::RecordedPlanes::make(std::move(planes));
  if (!made.value) return fail(ErrorCode::invalid_argument, path.string() + ": " + made.error);
  body.recorded = made.value->trajectory();
  body.source = std::move(made.value);
  return body;
}

bool is_volume(const std::filesystem::path& file) {
  return file.string().ends_with(".inr") || file.string().ends_with(".inr.gz");
}

Result<Body> file_body(const std::filesystem::path& file) {
  const auto suffix = file.extension();
  if (suffix == ".csl" || suffix == ".contour") return recorded_body(file);
  if (is_volume(file)) {
    auto volume = read_inr(file);
    if (!volume) return tl::unexpected<Error>(volume.error());
    return volume_body(std::move(*volume), file);
  }
  if (suffix == ".off" || suffix == ".stl" || suffix == ".ply" || suffix == ".obj") {
    auto mesh = read_mesh(file);
    if (!mesh) return tl::unexpected<Error>(mesh.error());
    return mesh_body(std::move(*mesh), file);
  }
  return fail(
      ErrorCode::unsupported_format,
      file.string() +
          " is no phantom: name liver, femur, organs, torso, or a file .csl .contour .off .stl .ply .obj .inr .inr.gz");
}

Result<Body> liver_body(const std::filesystem::path& file) {
  auto volume = read_inr(file);
  if (!volume) return tl::unexpected<Error>(volume.error());
  number_by_volume(*volume);
  return volume_body(std::move(*volume), file);
}

}  // namespace

Result<std::filesystem::path> find_data(const std::string& file, const std::optional<std::filesystem::path>& data) {
  const char* variable = std::getenv("SONOLOFT_DATA");
  const std::filesystem::path folder = data ? *data : variable ? variable : "build/data";
  for (const char* place : {"", "images", "meshes"}) {
    std::error_code ignored;
    if (const auto path = folder / place / file; std::filesystem::exists(path, ignored)) return path;
  }
  return fail(ErrorCode::file_not_found, "there is no " + file + " in " + folder.string() +
                                             ": let './run demo' unpack it, or name its folder with --data");
}

Result<Body> load_body(const std::string& name_or_file, const std::optional<std::filesystem::path>& data) {
  if (name_or_file == "organs") return solid_body(device_sim::organs_phantom(), {});
  if (name_or_file == "torso")
    return solid_body(device_sim::torso_phantom(), {static_cast<Label>(device_sim::Torso::bone)});
  if (name_or_file != "liver" && name_or_file != "femur") return file_body(name_or_file);
  const auto file = find_data(name_or_file == "liver" ? "liver.inr.gz" : "femur.off", data);
  if (!file) return tl::unexpected<Error>(file.error());
  return name_or_file == "liver" ? liver_body(*file) : file_body(*file);
}

Result<Truth> load_truth(const std::filesystem::path& file) {
  if (is_volume(file)) {
    auto volume = read_inr(file);
    if (!volume) return tl::unexpected<Error>(volume.error());
    return Truth(std::move(*volume));
  }
  auto mesh = read_mesh(file);
  if (!mesh) return tl::unexpected<Error>(mesh.error());
  return Truth(std::move(*mesh));
}

std::vector<Label> number_by_volume(LabelVolume& volume) {
  std::map<Label, std::size_t> voxels;
  for (const Label label : volume.labels)
    if (label != kOutside) ++voxels[label];
  std::vector<Label> order;
  for (const auto& [label, count] : voxels)
    if (count >= kNoiseVoxels) order.push_back(label);
  std::stable_sort(order.begin(), order.end(), [&](Label a, Label b) { return voxels[a] > voxels[b]; });
  std::vector<Label> number(std::size_t{kUnknown} + 1, kOutside);
  for (std::size_t i = 0; i < order.size(); ++i) number[order[i]] = static_cast<Label>(i + 1);
  for (Label& label : volume.labels) label = number[label];
  return order;
}

Result<Comparison> compare(const IndexedMesh& mesh, const Truth& truth, int threads) {
  if (const auto* voxels = std::get_if<LabelVolume>(&truth)) return measure_against_volume(mesh, *voxels, threads);
  return measure_against_mesh(mesh, std::get<IndexedMesh>(truth), threads);
}

}  // namespace sonoloft::tool
