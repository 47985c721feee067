#include "host/simulated/simulated_probe.h"

#include <utility>

#include "device_sim/probe/phantoms/torso_phantom.h"
#include "device_sim/simulator/simulated_device.h"
#include "host/device/loopback/loopback_transport.h"

namespace sonoloft {
namespace {

using device_sim::SimulatedDevice;

/// The way to a device that nobody else knows.
class SimulatedTransport final : public device::Transport {
 public:
  explicit SimulatedTransport(std::unique_ptr<SimulatedDevice> device)
      : device_(std::move(device)), loopback_(device_->port()) {}

  Result<std::size_t> control(std::span<const std::byte> request, std::span<std::byte> reply,
                              std::chrono::milliseconds timeout) override {
    return loopback_.control(request, reply, timeout);
  }
  Result<void> start_stream(device::TransferSink& sink, std::size_t max_record) override {
    return loopback_.start_stream(sink, max_record);
  }
  void stop_stream() override { loopback_.stop_stream(); }

 private:
  std::unique_ptr<SimulatedDevice> device_;
  device::LoopbackTransport loopback_;
};

device_sim::Subject subject(SimulatedPhantom phantom) {
  device_sim::Subject subject;
  if (phantom == SimulatedPhantom::torso) {
    subject.source = std::make_shared<device_sim::SolidPhantom>(device_sim::torso_phantom());
    subject.bones = {static_cast<device_sim::Label>(device_sim::Torso::bone)};
  } else {
    subject.source = std::make_shared<device_sim::SolidPhantom>(device_sim::organs_phantom());
  }
  return subject;
}

}  // namespace

Result<std::unique_ptr<device::Transport>> open_simulated_probe(const SimulatedProbeOptions& options) {
  constexpr std::uint32_t kMostSlices = 100'000;
  constexpr double kFastest_hz = 1000;
  if (options.slices == 0 || options.slices > kMostSlices)
    return fail(ErrorCode::invalid_argument, "a simulated probe sends 1 to 100000 slices");
  if (!(options.rate_hz >= 0 && options.rate_hz <= kFastest_hz))
    return fail(ErrorCode::invalid_argument, "a simulated probe sends 0 (unpaced) to 1000 slices a second");
  auto device =
      SimulatedDevice::make(subject(options.phantom), {options.slices, options.rate_hz, options.masks, options.seed});
  if (!device.value) return fail(ErrorCode::invalid_argument, device.error);
  return std::make_unique<SimulatedTransport>(std::move(device.value));
}

}  // namespace sonoloft
