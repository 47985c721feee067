#pragma once
#include <doctest/doctest.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "device_sim/simulator/memory_blobs.h"
#include "host/device/session.h"
#include "host/device/usb/usb_devices.h"
#include "host/device/usb/usb_transport.h"
#include "tests/support/wire/loopback_bench.h"
#include "tests/usb/umockdev/mock_bus.h"

namespace sonoloft::test {

inline constexpr device::StreamOptions kLossless{device::StreamMode::lossless, 16};

/// A device of the loopback that is reached over USB instead.
class UsbBench {
 public:
  explicit UsbBench(std::uint32_t slices, const char* serial = "USB-1", std::optional<double> rate_hz = {})
      : serial_(serial), loopback_(options(serial, rate_hz, &blobs_), numbered_slices(slices)) {}

  /// @pre no other probe of the bench's had this address
  void plug_into(MockBus& bus, int address = 1) {
    if (!probes_.empty()) probe().unplug();
    const device_sim::usb::UsbIdentity identity{serial_, device_sim::record_slot_len(kTestLimits)};
    probes_.push_back(std::make_unique<MockProbe>(bus, address, loopback_.port(), identity));
  }
  [[nodiscard]] MockProbe& probe() { return *probes_.back(); }
  [[nodiscard]] device_sim::LoopbackDevice& loopback() { return loopback_; }
  [[nodiscard]] const device_sim::MemoryBlobs& blobs() const { return blobs_; }

 private:
  static device_sim::LoopbackOptions options(const char* serial, std::optional<double> rate_hz,
                                             device_sim::BlobStore* blobs) {
    auto options = loopback_options();
    options.firmware.serial = {};
    std::copy_n(serial, std::char_traits<char>::length(serial), options.firmware.serial.begin());
    options.firmware.blobs = blobs;
    options.rate_hz = rate_hz;
    return options;
  }

  std::string serial_;
  device_sim::MemoryBlobs blobs_;
  device_sim::LoopbackDevice loopback_;
  std::vector<std::unique_ptr<MockProbe>> probes_;  ///< all but the last are unplugged
};

inline std::unique_ptr<device::Session> open_usb(std::string_view serial = {}) {
  auto transport = device::UsbTransport::open(serial);
  if (!transport) FAIL(transport.error().message);
  auto session = device::Session::open(std::move(*transport));
  if (!session) FAIL(session.error().message);
  return std::move(*session);
}

inline void check_in_order(const std::vector<std::shared_ptr<const device::DeliveredSlice>>& slices) {
  for (std::size_t i = 0; i < slices.size(); ++i) REQUIRE(slices[i]->slice.id == i);
}

/// What a live stream keeps to, however slow the machine.
inline void check_rising(const std::vector<std::shared_ptr<const device::DeliveredSlice>>& slices) {
  for (std::size_t i = 1; i < slices.size(); ++i) REQUIRE(slices[i]->slice.id > slices[i - 1]->slice.id);
}

}  // namespace sonoloft::test
