#pragma once
#include "protocol/slice.h"

// Stage 0 of the wire:  probe -> [ACQUIRED SLICE] -> firmware -> record -> bus

namespace sonoloft::device_sim {

/// What the acquisition hands to the firmware for every image: views of the acquisition's own arrays, which need to
/// live only during the call. See protocol/slice.h for frames, units and rules (contours one after the other without
/// gaps, 0 or at least 3 points of the field of view, finite numbers, poses that are not ok stay in and say so).
using AcquiredSlice = protocol::Slice;
using protocol::kHoleFlag;
using protocol::kUnknownLabel;
using protocol::PoseStatus;

}  // namespace sonoloft::device_sim
