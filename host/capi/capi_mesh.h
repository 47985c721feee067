#pragma once
// MeshUpdate -> [SONOLOFT_MESH] -> C
#include <Eigen/Geometry>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "core/mesh/mesh.h"
#include "host/capi/sonoloft.h"
#include "host/scan/mesh_update.h"

/// A mesh update as C reads it. Threads: any; it does not change.
struct sonoloft_mesh {
  /// Has one reference, the caller's.
  explicit sonoloft_mesh(std::shared_ptr<const sonoloft::MeshUpdate> update);

  std::atomic<int> references = 1;
  std::shared_ptr<const sonoloft::MeshUpdate> update;
  sonoloft_mesh_info info{};
  std::vector<sonoloft_label> labels;
  std::vector<sonoloft_slice> slices;
  std::vector<std::vector<sonoloft_contour>> contours;  ///< of each slice

  // Made when they are first asked for.
  mutable std::once_flag joined;
  mutable sonoloft::IndexedMesh mesh;
  mutable std::vector<std::uint16_t> label_pairs;
  mutable sonoloft_mesh_arrays arrays{};
  mutable std::once_flag cut;
  mutable std::vector<sonoloft_chunk> chunks;  ///< those that changed
  mutable std::vector<std::vector<std::uint16_t>> chunk_label_pairs;
};

namespace sonoloft::capi {

/// Front and back of every triangle.
[[nodiscard]] std::vector<std::uint16_t> label_pairs_of(const std::vector<Label>& front,
                                                        const std::vector<Label>& back);

[[nodiscard]] std::vector<sonoloft_contour> contours_of(const TrackedSlice& slice);
/// Undecided. @pre `slice` and `contours` outlive what is returned
[[nodiscard]] sonoloft_slice slice_of(const device::DeliveredSlice& slice,
                                      const std::vector<sonoloft_contour>& contours);

/// 3 by 4, row by row.
void write_rows(const Eigen::Isometry3d& pose, double (&rows)[12]);

}  // namespace sonoloft::capi
