#pragma once
#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>
#include <utility>

#include "host/capi/sonoloft.h"

namespace sonoloft::test {

inline sonoloft_probe* simulated_probe(std::uint32_t slices, double rate_hz = 0) {
  sonoloft_simulation simulation{};
  simulation.size = sizeof simulation;
  simulation.slices = slices;
  simulation.rate_hz = rate_hz;
  sonoloft_probe* probe = nullptr;
  sonoloft_error error{};
  REQUIRE_MESSAGE(sonoloft_open_simulated(&simulation, &probe, &error) == SONOLOFT_OK, error.message);
  return probe;
}

/// Coarse; no slice is lost.
inline sonoloft_scan_options scan_options() {
  sonoloft_scan_options options{};
  options.size = sizeof options;
  for (int axis = 0; axis < 3; ++axis) {
    options.box_min_mm[axis] = -300;
    options.box_max_mm[axis] = 300;
  }
  options.spacing_mm = 12;
  options.background_mm = 6;
  options.processor_only = 1;
  options.lossless = 1;
  return options;
}

inline sonoloft_scan* open_scan(std::uint32_t slices, double rate_hz = 0,
                                const sonoloft_scan_options& options = scan_options()) {
  sonoloft_scan* scan = nullptr;
  sonoloft_error error{};
  REQUIRE_MESSAGE(sonoloft_scan_open(simulated_probe(slices, rate_hz), &options, &scan, &error) == SONOLOFT_OK,
                  error.message);
  return scan;
}

inline sonoloft_statistics statistics_of(const sonoloft_scan* scan) {
  sonoloft_statistics statistics{};
  statistics.size = sizeof statistics;
  REQUIRE(sonoloft_scan_statistics(scan, &statistics, nullptr) == SONOLOFT_OK);
  return statistics;
}

/// Follows a scan; what a test wants to do in on_mesh comes with it.
class Follower {
 public:
  explicit Follower(std::function<void(sonoloft_mesh*)> then = {}) : then_(std::move(then)) {}
  ~Follower() { sonoloft_mesh_release(last_); }
  Follower(const Follower&) = delete;
  Follower& operator=(const Follower&) = delete;

  void start(sonoloft_scan* scan) {
    const sonoloft_callbacks callbacks{sizeof callbacks, this, &on_mesh, &on_event, &on_slice};
    sonoloft_error error{};
    REQUIRE_MESSAGE(sonoloft_scan_start(scan, &callbacks, &error) == SONOLOFT_OK, error.message);
  }
  bool wait_for(sonoloft_event_kind kind) const {
    return wait([this, kind] { return events(kind) > 0; });
  }
  bool wait_for_meshes(int count) const {
    return wait([this, count] { return meshes_ >= count; });
  }
  [[nodiscard]] int meshes() const { return meshes_; }
  [[nodiscard]] int slices() const { return slices_; }
  [[nodiscard]] int events(sonoloft_event_kind kind) const { return events_[kind]; }
  [[nodiscard]] const sonoloft_mesh* last() const { return last_; }  ///< @pre the run is over

 private:
  static void on_mesh(void* user, sonoloft_mesh* mesh) {
    auto* self = static_cast<Follower*>(user);
    sonoloft_mesh_release(self->last_);
    self->last_ = sonoloft_mesh_retain(mesh);
    ++self->meshes_;
    if (self->then_) self->then_(mesh);
  }
  static void on_slice(void* user, const sonoloft_slice* slice) {
    auto* self = static_cast<Follower*>(user);
    CHECK(slice->fate == SONOLOFT_UNDECIDED);
    CHECK(slice->field_of_view_points >= 3);
    ++self->slices_;
  }
  static void on_event(void* user, const sonoloft_event* event) {
    ++static_cast<Follower*>(user)->events_[event->kind];
  }
  /// False only when it never happens.
  template <class Condition>
  static bool wait(Condition condition) {
    for (int ms = 0; ms < 60'000; ++ms) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

  std::function<void(sonoloft_mesh*)> then_;
  sonoloft_mesh* last_ = nullptr;
  std::atomic<int> meshes_ = 0;
  std::atomic<int> events_[SONOLOFT_BUTTON + 1] = {};
  std::atomic<int> slices_ = 0;
};

}  // namespace sonoloft::test
