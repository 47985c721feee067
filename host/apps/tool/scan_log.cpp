#include "host/apps/tool/scan_log.h"

#include <cstdio>
#include <iostream>
#include <utility>

namespace sonoloft::tool {

ScanCallbacks ScanLog::callbacks() {
  return {[this](std::shared_ptr<const MeshUpdate> update) { take(std::move(update)); },
          [this](const ScanEvent& event) { take(event); }};
}

void ScanLog::take(std::shared_ptr<const MeshUpdate> update) {
  for (const SliceReport& slice : update->slices)
    if (slice.fate == SliceFate::refused)
      std::cerr << "sonoloft: slice " << slice.slice->slice.id << " is refused: " << slice.reason << '\n';
  const std::lock_guard lock(mutex_);
  if (!last_) first_arrival_ = update->slices.front().slice->arrival;
  for (const SliceReport& slice : update->slices) {
    last_arrival_ = slice.slice->arrival;
    latencies_ms_.push_back(slice.latency_ms);
  }
  if (!update->slices.empty()) reconstruct_ms_.push_back(update->reconstruct_ms);
  coarse_meshes_ += update->detail != Detail::full ? 1 : 0;
  last_ = std::move(update);
}

void ScanLog::take(const ScanEvent& event) {
  if (event.kind != ScanEventKind::end_of_data) std::cerr << "sonoloft: " << event.message << '\n';
  if (!ends_run(event.kind)) return;
  const std::lock_guard lock(mutex_);
  if (event.kind == ScanEventKind::reconstruction_failed) failure_ = event.message;
  data_ended_ = event.kind == ScanEventKind::end_of_data;
  ended_ = true;
  changed_.notify_all();
}

bool ScanLog::wait_for_end(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, patience, [&] { return ended_; });
}

bool ScanLog::data_ended() const {
  const std::lock_guard lock(mutex_);
  return data_ended_;
}

std::string ScanLog::progress() const {
  const std::lock_guard lock(mutex_);
  if (!last_) return {};
  const double seconds = std::chrono::duration<double>(last_arrival_ - first_arrival_).count();
  const double rate_hz = seconds > 0.5 ? static_cast<double>(last_->revision - 1) / seconds : 0;
  char line[160];
  std::snprintf(line, sizeof line, "%llu slices  %.1f Hz  latency %.0f ms  %zu labels  %zu triangles  %llu dropped",
                static_cast<unsigned long long>(last_->revision), rate_hz, latencies_ms_.back(), last_->labels.size(),
                last_->size.triangles, static_cast<unsigned long long>(last_->counts.dropped));
  return line;
}

std::shared_ptr<const MeshUpdate> ScanLog::last() const {
  const std::lock_guard lock(mutex_);
  return last_;
}

std::optional<std::string> ScanLog::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

std::vector<double> ScanLog::latencies_ms() const {
  const std::lock_guard lock(mutex_);
  return latencies_ms_;
}

std::vector<double> ScanLog::reconstruct_ms() const {
  const std::lock_guard lock(mutex_);
  return reconstruct_ms_;
}

std::size_t ScanLog::coarse_meshes() const {
  const std::lock_guard lock(mutex_);
  return coarse_meshes_;
}

}  // namespace sonoloft::tool
