#pragma once
// phantom, plan -> [SIMULATED PROBE] -> transport -> session, scan
#include <cstdint>
#include <memory>

#include "core/slice/result.h"
#include "host/device/transport.h"

namespace sonoloft {

enum class SimulatedPhantom : std::uint8_t {
  organs,  ///< an abdomen of five labels, all of each section seen: no noise but the hand's tremor
  torso,   ///< as a patient is scanned: ribs that shadow, a sector that sees a part, noise, lost contact
};

struct SimulatedProbeOptions {
  SimulatedPhantom phantom = SimulatedPhantom::organs;
  std::uint32_t slices = 60;  ///< 1 to 100000, then its data end
  double rate_hz = 10;        ///< up to 1000; 0: as fast as the host takes them, and a lossless stream makes it wait
  bool masks = false;         ///< it sends a label for every pixel instead of contours
  std::uint64_t seed = 1;     ///< of the hand and of all noise: the same seed gives the same slices
};

/// A probe that lives in this process and answers as one on a cable does: for ScanSession::open() and
/// device::Session::open(). It goes away with its transport. The phantoms lie within 130 mm of the origin.
/// @error invalid_argument @cost some milliseconds; a thread of its own, that makes a slice in some milliseconds
[[nodiscard]] Result<std::unique_ptr<device::Transport>> open_simulated_probe(const SimulatedProbeOptions& options);

}  // namespace sonoloft
