#include "host/capi/capi_mesh.h"

#include <new>
#include <utility>

using namespace sonoloft;

namespace sonoloft::capi {

static_assert(SONOLOFT_DRAFT == static_cast<int>(Detail::draft));
static_assert(SONOLOFT_REFUSED == static_cast<int>(SliceFate::refused));
static_assert(SONOLOFT_UNKNOWN_LABEL == kUnknown);
// What C reads as flat arrays.
static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
static_assert(sizeof(Eigen::Vector2d) == 2 * sizeof(double));
static_assert(sizeof(std::array<std::uint32_t, 3>) == 3 * sizeof(std::uint32_t));

void write_rows(const Eigen::Isometry3d& pose, double (&rows)[12]) {
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>{rows} = pose.matrix().topRows<3>();
}

namespace {

const double* flat(const std::vector<Eigen::Vector2d>& points) {
  return points.empty() ? nullptr : points.front().data();
}

std::vector<sonoloft_contour> contours_of(const TrackedSlice& slice) {
  std::vector<sonoloft_contour> contours;
  for (const Contour& c : slice.contours)
    contours.push_back({c.first, c.count, c.label, static_cast<std::uint16_t>(c.hole)});
  return contours;
}

sonoloft_slice slice_of(const SliceReport& report, const std::vector<sonoloft_contour>& contours) {
  const device::DeliveredSlice& delivered = *report.slice;
  const TrackedSlice& slice = delivered.slice;
  sonoloft_slice out{};
  out.id = slice.id;
  out.time_ns = slice.time.count();
  out.pose_time_ns = delivered.pose_time.count();
  out.pose_ok = delivered.pose_status == device::PoseStatus::ok;
  out.pose_error_mm = delivered.pose_error_mm;
  write_rows(slice.image_to_reference, out.image_to_reference);
  out.points = slice.points.size();
  out.contours = contours.size();
  out.field_of_view_points = slice.field_of_view.size();
  out.points_mm = flat(slice.points);
  out.contour = contours.data();
  out.field_of_view_mm = flat(slice.field_of_view);
  out.fate = static_cast<sonoloft_fate>(report.fate);
  out.reason = report.reason.c_str();
  out.latency_ms = report.latency_ms;
  return out;
}

void join(const sonoloft_mesh& m) {
  m.mesh = m.update->mesh.indexed();
  m.label_pairs.resize(2 * m.mesh.triangles.size());
  for (std::size_t t = 0; t < m.mesh.triangles.size(); ++t) {
    m.label_pairs[2 * t] = m.mesh.label_front[t];
    m.label_pairs[2 * t + 1] = m.mesh.label_back[t];
  }
  m.arrays = {m.mesh.positions.size(), m.mesh.triangles.size(), nullptr, nullptr, m.label_pairs.data()};
  if (m.mesh.triangles.empty()) return;
  m.arrays.positions_mm = m.mesh.positions.front().data();
  m.arrays.corners = m.mesh.triangles.front().data();
}

}  // namespace
}  // namespace sonoloft::capi

sonoloft_mesh::sonoloft_mesh(std::shared_ptr<const MeshUpdate> made) : update(std::move(made)) {
  for (const LabelStatistics& l : update->labels) labels.push_back({l.label, l.triangles, l.volume_ml});
  for (const SliceReport& report : update->slices) {
    contours.push_back(capi::contours_of(report.slice->slice));
    slices.push_back(capi::slice_of(report, contours.back()));
  }
  info = {update->revision, update->skipped_revisions, static_cast<sonoloft_detail>(update->detail), labels.size(),
          slices.size(),    update->reconstruct_ms};
}

sonoloft_mesh* sonoloft_mesh_retain(sonoloft_mesh* mesh) {
  if (mesh) mesh->references.fetch_add(1, std::memory_order_relaxed);
  return mesh;
}

void sonoloft_mesh_release(sonoloft_mesh* mesh) {
  if (mesh && mesh->references.fetch_sub(1, std::memory_order_acq_rel) == 1) delete mesh;
}

const sonoloft_mesh_info* sonoloft_mesh_get_info(const sonoloft_mesh* mesh) {
  return mesh ? &mesh->info : nullptr;
}

const sonoloft_mesh_arrays* sonoloft_mesh_get_arrays(const sonoloft_mesh* mesh) {
  if (!mesh) return nullptr;
  try {
    std::call_once(mesh->joined, [mesh] { capi::join(*mesh); });
    return &mesh->arrays;
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

const sonoloft_label* sonoloft_mesh_label(const sonoloft_mesh* mesh, size_t index) {
  return mesh && index < mesh->labels.size() ? &mesh->labels[index] : nullptr;
}

const sonoloft_slice* sonoloft_mesh_slice(const sonoloft_mesh* mesh, size_t index) {
  return mesh && index < mesh->slices.size() ? &mesh->slices[index] : nullptr;
}
