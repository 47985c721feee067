#pragma once
// What a minute of scanning looks like: a small convex array at 20 Hz, a trembling hand, an imperfect tracker.
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "device_sim/probe/simulated_probe.h"
#include "tests/support/probe_slices.h"

namespace sonoloft::test {

/// 60 degrees from 4 to 62 mm, tracked to 0.2 mm and 0.2 degrees; nothing else is wrong yet.
inline device_sim::ProbeOptions live_probe(std::uint64_t seed) {
  device_sim::ProbeOptions options;
  options.seed = seed;
  options.rate_hz = 20;
  options.sector = device_sim::kConvexArray;
  options.tracker_rms_mm = options.tracker_rms_deg = 0.2;
  return options;
}

/// The slices of a probe that follows a trajectory. @pre the options are in range
inline std::vector<TrackedSlice> live_scan(std::shared_ptr<const device_sim::SectionSource> body,
                                           device_sim::Trajectory trajectory, device_sim::ProbeOptions options) {
  return slices_of(*device_sim::SimulatedProbe::make(std::move(options), std::move(body), std::move(trajectory)).value);
}

/// Five passes over the body with the apex this deep in its box; see pass_sweep().
inline device_sim::Trajectory live_passes(const device_sim::SectionSource& body, std::uint32_t slices, double deep_mm,
                                          std::uint64_t seed) {
  constexpr double kApart_mm = 35;  // neighbours overlap from half the sector's depth on
  device_sim::Hand hand;
  hand.seed = seed;
  return device_sim::pass_sweep(body.bounds(), {slices, -deep_mm}, kApart_mm, hand);
}

/// A probe held still over the middle of the body.
inline device_sim::Trajectory live_standstill(const device_sim::SectionSource& body, std::uint32_t slices,
                                              double deep_mm, std::uint64_t seed) {
  device_sim::Hand hand;
  hand.seed = seed;
  return device_sim::still_probe(body.bounds(), {slices, -deep_mm}, hand);
}

}  // namespace sonoloft::test
