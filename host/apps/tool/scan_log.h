#pragma once
// ScanSession -> [SCAN LOG] -> progress, figures
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "host/scan/scan_session.h"

namespace sonoloft::tool {

/// Keeps what a scan reports. Threads: any.
class ScanLog {
 public:
  /// To be started with. @pre the log outlives the run
  [[nodiscard]] ScanCallbacks callbacks();

  /// Waits up to `patience` for the end of the run. @return whether nothing more is to come
  [[nodiscard]] bool wait_for_end(std::chrono::milliseconds patience);

  /// The device has nothing more; else the run ended for another reason.
  [[nodiscard]] bool data_ended() const;

  /// Slices, rate, latency and the like so far; empty before the first mesh.
  [[nodiscard]] std::string progress() const;

  [[nodiscard]] std::shared_ptr<const MeshUpdate> last() const;  ///< null where there was no mesh
  [[nodiscard]] std::optional<std::string> failure() const;      ///< of the reconstruction
  [[nodiscard]] std::vector<double> latencies_ms() const;        ///< of every slice that a mesh was delivered with
  [[nodiscard]] std::vector<double> reconstruct_ms() const;      ///< of every mesh of new slices
  [[nodiscard]] std::size_t coarse_meshes() const;               ///< of all meshes delivered

 private:
  void take(std::shared_ptr<const MeshUpdate> update);
  void take(const ScanEvent& event);

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false, data_ended_ = false;
  std::optional<std::string> failure_;
  std::shared_ptr<const MeshUpdate> last_;
  std::chrono::steady_clock::time_point first_arrival_, last_arrival_;
  std::vector<double> latencies_ms_, reconstruct_ms_;
  std::size_t coarse_meshes_ = 0;
};

}  // namespace sonoloft::tool
