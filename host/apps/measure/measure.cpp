#include "host/apps/measure/measure.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "host/apps/measure/distance.h"
#include "host/apps/measure/overlap.h"

namespace sonoloft {
namespace {

constexpr double kLinesAcross = 512;
constexpr double kMaxLinesASide = 1 << 20;

Result<void> check(const LabelVolume& volume) {
  std::uint64_t voxels = 1;
  for (const std::uint32_t side : volume.dims) voxels *= std::min(side, kMaxVolumeSide + 1);
  if (voxels == 0 || voxels != volume.labels.size() ||
      *std::max_element(volume.dims.begin(), volume.dims.end()) > kMaxVolumeSide) {
    return fail(ErrorCode::invalid_argument, "the volume's sizes do not fit its number of voxels: read it again");
  }
  if (!volume.origin_mm.allFinite() || !volume.spacing_mm.allFinite() || !(volume.spacing_mm.array() > 0).all()) {
    return fail(ErrorCode::invalid_argument,
                "the volume's spacing must be positive and its origin finite: give both in mm");
  }
  return {};
}

ScanLines lines_through(const Eigen::AlignedBox3d& box) {
  const Eigen::Vector3d size = box.sizes();
  const double step = std::max({size.y(), size.z(), 1e-9}) / kLinesAcross;
  const auto ticks = [&](int axis) {
    const auto count = static_cast<std::size_t>(std::ceil(size[axis] / step)) + 1;
    // Centred, so that lines do not prefer one end.
    return Ticks{box.center()[axis] - 0.5 * step * static_cast<double>(count - 1), step, count};
  };
  return {Ticks{0, 0, 0}, ticks(1), ticks(2)};
}

/// The volume's own grid, continued over the box of the mesh. `offset` gets the index of voxel (0, 0, 0).
Result<ScanLines> lines_of(const LabelVolume& volume, const Eigen::AlignedBox3d& mesh_box,
                           std::array<std::size_t, 3>& offset) {
  std::array<Ticks, 3> ticks;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const double step = volume.spacing_mm[axis], origin = volume.origin_mm[axis], side = volume.dims[i];
    const double before = std::max(0.0, std::ceil((origin - mesh_box.min()[axis]) / step));
    const double after = std::max(0.0, std::ceil((mesh_box.max()[axis] - origin) / step) - side + 1);
    if (!(before + side + after <= kMaxLinesASide)) {
      return fail(ErrorCode::too_large,
                  "the mesh reaches far beyond the volume: check that both are in one frame and in mm");
    }
    offset[i] = static_cast<std::size_t>(before);
    ticks[i] = {origin - before * step, step, static_cast<std::size_t>(before + side + after)};
  }
  return ScanLines{ticks[0], ticks[1], ticks[2]};
}

Comparison compare(const OverlapInput& input, const IndexedMesh& truth_surface, const ScanLines& lines,
                   double truth_diagonal_mm, int threads) {
  Overlap overlap = scan_overlap(input, lines, threads);
  const SurfaceDistance surface = surface_distance(input.mesh, truth_surface, threads);
  Comparison result{std::move(overlap.labels), {}, surface, truth_diagonal_mm, overlap.open_lines};
  for (const LabelOverlap& label : result.overlaps) {
    const bool all = result.overlaps.size() == 1;
    result.distances.push_back(
        {label.label, all ? surface
                          : surface_distance(triangles_of(input.mesh, label.label),
                                             triangles_of(truth_surface, label.label), threads)});
  }
  return result;
}

}  // namespace

Result<Comparison> measure_against_mesh(const IndexedMesh& mesh, const IndexedMesh& truth, int threads) {
  auto mesh_box = used_box(mesh, "the mesh");
  if (!mesh_box) return tl::unexpected(mesh_box.error());
  auto truth_box = used_box(truth, "the true mesh");
  if (!truth_box) return tl::unexpected(truth_box.error());
  const ScanLines lines = lines_through(mesh_box->merged(*truth_box));
  return compare({mesh, &truth, nullptr, {}}, truth, lines, truth_box->diagonal().norm(), threads);
}

Result<Comparison> measure_against_volume(const IndexedMesh& mesh, const LabelVolume& truth, int threads) {
  if (auto ok = check(truth); !ok) return tl::unexpected(ok.error());
  auto mesh_box = used_box(mesh, "the mesh");
  if (!mesh_box) return tl::unexpected(mesh_box.error());
  const IndexedMesh surface = voxel_surface(truth);
  auto truth_box = used_box(surface, "the true volume");
  if (!truth_box) return tl::unexpected(truth_box.error());
  std::array<std::size_t, 3> offset{};
  auto lines = lines_of(truth, *mesh_box, offset);
  if (!lines) return tl::unexpected(lines.error());
  return compare({mesh, nullptr, &truth, offset}, surface, *lines, truth_box->diagonal().norm(), threads);
}

}  // namespace sonoloft
