#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "host/device/clock/clock_keeper.h"
#include "host/device/ledger.h"
#include "protocol/accept.h"

namespace sonoloft::device {

/// What a run knows of itself, now or at its end.
struct Statistics {
  Ledger ledger;
  std::array<std::uint64_t, protocol::kRejectCount> rejected{};  ///< transfers, by protocol::Reject; [none] stays 0
  std::uint64_t events_lost = 0;      ///< that the device told, and that did not arrive or found no room
  std::optional<ClockFigures> clock;  ///< nothing where no slice's time could be mapped
};

}  // namespace sonoloft::device
