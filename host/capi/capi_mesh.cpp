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

}  // namespace

std::vector<sonoloft_contour> contours_of(const TrackedSlice& slice) {
  std::vector<sonoloft_contour> contours;
  for (const Contour& c : slice.contours)
    contours.push_back({c.first, c.count, c.label, static_cast<std::uint16_t>(c.hole)});
  return contours;
}

sonoloft_slice slice_of(const device::DeliveredSlice& delivered, const std::vector<sonoloft_contour>& contours) {
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
  out.fate = SONOLOFT_UNDECIDED;
  out.reason = "";
  return out;
}

std::vector<std::uint16_t> label_pairs_of(const std::vector<Label>& front, const std::vector<Label>& back) {
  std::vector<std::uint16_t> pairs(2 * front.size());
  for (std::size_t t = 0; t < front.size(); ++t) {
    pairs[2 * t] = front[t];
    pairs[2 * t + 1] = back[t];
  }
  return pairs;
}

namespace {

sonoloft_slice reported(const SliceReport& report, const std::vector<sonoloft_contour>& contours) {
  sonoloft_slice out = slice_of(*report.slice, contours);
  out.fate = static_cast<sonoloft_fate>(report.fate);
  out.reason = report.reason.c_str();
  out.latency_ms = report.latency_ms;
  return out;
}

void join(const sonoloft_mesh& m) {
  m.mesh = m.update->mesh.indexed();
  m.label_pairs = label_pairs_of(m.mesh.label_front, m.mesh.label_back);
  m.arrays = {m.mesh.positions.size(), m.mesh.triangles.size(), nullptr, nullptr, m.label_pairs.data()};
  if (m.mesh.triangles.empty()) return;
  m.arrays.positions_mm = m.mesh.positions.front().data();
  m.arrays.corners = m.mesh.triangles.front().data();
}

sonoloft_chunk chunk_of(const MeshChunk& chunk, const std::vector<std::uint16_t>& label_pairs) {
  return {chunk.coord.x,
          chunk.coord.y,
          chunk.coord.z,
          chunk.positions.size(),
          chunk.triangles.size(),
          chunk.positions.front().data(),
          chunk.triangles.front().data(),
          label_pairs.data()};
}

// Both lists ascend by coordinates.
void cut(const sonoloft_mesh& m) {
  m.chunks.clear();  // of a time that found no memory
  m.chunk_label_pairs.clear();
  auto chunk = m.update->mesh.chunks.begin();
  const auto end = m.update->mesh.chunks.end();
  for (const BrickCoord& coord : m.update->changed_chunks) {
    while (chunk != end && (*chunk)->coord < coord) ++chunk;
    if (chunk == end || coord < (*chunk)->coord) {
      m.chunks.push_back({coord.x, coord.y, coord.z, 0, 0, nullptr, nullptr, nullptr});
      continue;
    }
    m.chunk_label_pairs.push_back(label_pairs_of((*chunk)->label_front, (*chunk)->label_back));
    m.chunks.push_back(chunk_of(**chunk, m.chunk_label_pairs.back()));
  }
}

}  // namespace
}  // namespace sonoloft::capi

sonoloft_mesh::sonoloft_mesh(std::shared_ptr<const MeshUpdate> made) : update(std::move(made)) {
  for (const LabelStatistics& l : update->labels) labels.push_back({l.label, l.triangles, l.volume_ml});
  for (const SliceReport& report : update->slices) {
    contours.push_back(capi::contours_of(report.slice->slice));
    slices.push_back(capi::reported(report, contours.back()));
  }
  info = {update->revision,
          update->skipped_revisions,
          static_cast<sonoloft_detail>(update->detail),
          update->settled ? 1 : 0,
          labels.size(),
          slices.size(),
          update->reconstruct_ms};
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

size_t sonoloft_mesh_changed_chunks(const sonoloft_mesh* mesh) {
  return mesh ? mesh->update->changed_chunks.size() : 0;
}

const sonoloft_chunk* sonoloft_mesh_changed_chunk(const sonoloft_mesh* mesh, size_t index) {
  if (index >= sonoloft_mesh_changed_chunks(mesh)) return nullptr;
  try {
    std::call_once(mesh->cut, [mesh] { capi::cut(*mesh); });
    return &mesh->chunks[index];
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
