#pragma once
// What a scan hands to your callback:  device, core -> scan -> [MESH UPDATE] -> callback
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/octree/brick.h"
#include "core/reconstructor/reconstructor.h"
#include "host/device/delivered_slice.h"
#include "host/scan/label_statistics.h"

namespace sonoloft {

/// What became of a slice that a scan took in.
enum class SliceFate : std::uint8_t {
  inserted,   ///< it cut cells: the mesh may have changed
  explained,  ///< it says what was known already, and cut nothing
  merged,     ///< it says something new, but lies too near to earlier slices to cut: it counts in the background only
  refused,    ///< it is not used, for the reason given: no sound pose, or not a sound slice
};

struct SliceReport {
  std::shared_ptr<const device::DeliveredSlice> slice;
  SliceFate fate;
  std::string reason;  ///< of a refused slice: one line, cause and remedy
  double insert_ms;    ///< cutting the cells
  double latency_ms;   ///< from the slice's arrival at the host to the call of on_mesh that carries it
};

/// Where the slices of a scan went, since it was opened.
/// delivered == inserted + explained + merged + refused + dropped + those that wait now.
struct SliceCounts {
  std::uint64_t delivered = 0;  ///< came from the device
  std::uint64_t inserted = 0, explained = 0, merged = 0, refused = 0;
  std::uint64_t dropped = 0;  ///< gave way to newer ones in the queue, or were there when the run ended

  bool operator==(const SliceCounts&) const = default;
};

/// One delivery of a scan: the mesh of all slices so far. Every slice taken in makes a revision; slices that waited
/// together, since your callback or the reconstruction was still busy, are delivered as the last revision of them.
/// While slices of a live scan come faster than full detail allows, the mesh is coarse, and while they come at all it
/// is not settled; a full, settled one of the same revision follows as soon as slices pause, and comes before
/// end_of_data and disconnected. After a withdrawal comes a mesh of the same revision. Immutable: keep it as long as
/// you like, from any thread.
struct MeshUpdate {
  std::uint64_t revision;           ///< slices taken in so far, of all runs of the scan
  std::uint64_t skipped_revisions;  ///< of them never delivered by themselves, so far

  Detail detail;
  bool settled;  ///< see Slopes: it is what all slices so far give at this detail
  MeshSnapshot mesh;
  std::vector<BrickCoord> changed_chunks;  ///< against the delivery before: changed, appeared or vanished; ascending
  std::vector<LabelStatistics> labels;     ///< ascending by label
  ReconstructorCounts size;

  std::vector<SliceReport> slices;  ///< taken in since the delivery before, in order; none when only the
                                    ///< detail is new
  SliceCounts counts;
  double reconstruct_ms;  ///< from taking these slices out of the queue to the finished mesh
};

}  // namespace sonoloft
