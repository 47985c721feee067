#pragma once
#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "device_sim/probe/simulated_probe.h"
#include "host/device/calibration.h"

namespace sonoloft::test {

/// What a host makes of a probe's remaining images, without the wire between: those whose pose is good, in mm.
inline std::vector<TrackedSlice> slices_of(device_sim::SimulatedProbe& probe) {
  std::vector<TrackedSlice> slices;
  while (const auto frame = probe.next()) {
    if (frame->pose.status != protocol::PoseStatus::ok) continue;
    protocol::CalibrationMessage message{};
    message.id = frame->calibration_id;
    const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rows = probe.image_to_probe();
    std::copy_n(rows.data(), rows.size(), message.image_to_probe);
    auto delivered = device::to_delivered(frame->view(), frame->index, device::make_calibration(message).value(), {});
    slices.push_back(std::move(delivered.slice));
  }
  return slices;
}

}  // namespace sonoloft::test
