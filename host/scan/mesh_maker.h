#pragma once
// device -> slices -> [MESH MAKER] -> MeshUpdate -> your callback
#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/reconstructor/reconstructor.h"
#include "core/slice/result.h"
#include "host/device/delivered_slice.h"
#include "host/scan/label_statistics.h"
#include "host/scan/mesh_update.h"

namespace sonoloft {

/// What a scan does with its slices, without any thread. Threads: one at a time.
class MeshMaker {
 public:
  /// @error those of Reconstructor::create()
  [[nodiscard]] static Result<MeshMaker> create(const ReconstructorOptions& options);

  /// The mesh follows with the next make(), and what became of the slice with it.
  void add(std::shared_ptr<const device::DeliveredSlice> slice);

  /// See Reconstructor.
  [[nodiscard]] std::array<std::size_t, kDetails> samples_due() const { return reconstructor_.samples_due(); }

  /// Brings the mesh of this detail up to date with the slices added since the last one, if any.
  /// @post  in the update everything is set but `counts` and the slices' latency_ms
  /// @error opencl_failed: the maker is not to be used any more
  [[nodiscard]] Result<std::shared_ptr<MeshUpdate>> make(Detail detail, Slopes slopes);
  /// UpdateReport::sampling_ms() of the last one.
  [[nodiscard]] double sampling_ms() const { return sampling_ms_; }

  /// See Reconstructor. The mesh follows with the next make().
  [[nodiscard]] Result<void> withdraw(std::uint64_t slice_id) { return reconstructor_.withdraw(slice_id); }
  [[nodiscard]] Confidence confidence(std::span<const Eigen::Vector3f> points_mm) {
    return reconstructor_.confidence(points_mm);
  }
  [[nodiscard]] Coverage coverage() { return reconstructor_.coverage(); }

  [[nodiscard]] std::string field_device() const { return reconstructor_.device_name(); }

 private:
  using Clock = std::chrono::steady_clock;
  MeshMaker(Reconstructor reconstructor, const Eigen::Vector3d& centre_mm)
      : reconstructor_(std::move(reconstructor)), statistics_(kDetails, LabelStatisticsKeeper(centre_mm)) {}
  Reconstructor reconstructor_;
  std::vector<SliceReport> added_;  ///< since the last make() ...
  Clock::duration adding_{};        ///< ... which took so long
  double sampling_ms_ = 0;
  std::vector<LabelStatisticsKeeper> statistics_;  ///< [Detail]
  struct Shown {
    Detail detail = Detail::full;
    MeshSnapshot mesh;
  };
  Shown shown_;  ///< what was made last
  std::uint64_t revision_ = 0, skipped_revisions_ = 0;
};

}  // namespace sonoloft
