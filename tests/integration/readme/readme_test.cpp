#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <sstream>

#include "device_sim/port/loopback_device.h"
#include "device_sim/probe/phantoms/solid_phantom.h"
#include "device_sim/probe/simulated_probe.h"
#include "host/device/loopback/loopback_transport.h"
#include "readme_program.h"  // made from README.md

namespace {

using namespace sonoloft::device_sim;

/// A simulated probe that scans a ball, and the device around it.
class BallDevice {
 public:
  BallDevice() {
    const auto ball = std::make_shared<SolidPhantom>(std::vector<Solid>{sphere({0, 0, 0}, 40, 1)});
    probe_ = SimulatedProbe::make({}, ball, linear_sweep(ball->bounds(), {12, {}})).value;
    REQUIRE(probe_);
    LoopbackOptions options;
    options.firmware.calibration.id = 1;
    const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rows = probe_->image_to_probe();
    std::copy_n(rows.data(), rows.size(), options.firmware.calibration.image_to_probe);
    device_ = std::make_unique<LoopbackDevice>(options, [this] { return next(); });
  }

  sonoloft::protocol::Port& port() { return device_->port(); }

 private:
  const AcquiredSlice* next() {
    frame_ = probe_->next();
    if (!frame_) return nullptr;
    view_ = frame_->view();
    return &view_;
  }

  std::unique_ptr<SimulatedProbe> probe_;
  std::optional<SimulatedFrame> frame_;
  AcquiredSlice view_;
  std::unique_ptr<LoopbackDevice> device_;
};

/// What the program writes while it scans for so long.
std::string output_of_scan(std::chrono::seconds duration) {
  BallDevice device;
  std::ostringstream text;
  std::streambuf* const terminal = std::cout.rdbuf(text.rdbuf());
  const auto done = scan(std::make_unique<sonoloft::device::LoopbackTransport>(device.port()), duration);
  std::cout.rdbuf(terminal);
  REQUIRE_MESSAGE(done, done.error().message);
  return text.str();
}

}  // namespace

TEST_CASE("readme: its program scans a ball and says how large it is") {
  const double ball_ml = 4.0 / 3.0 * 3.14159265 * 64;
  double volume_ml = 0;
  // On a machine that has much else to do it gets more time.
  for (std::chrono::seconds duration(1); duration.count() <= 32 && volume_ml < 0.9 * ball_ml; duration *= 2) {
    const std::string text = output_of_scan(duration);
    const std::string line = "label 1: ";
    const auto last = text.rfind(line);
    if (last != std::string::npos) volume_ml = std::strtod(text.c_str() + last + line.size(), nullptr);
  }
  MESSAGE("volume ", volume_ml, " ml of ", ball_ml);
  CHECK(volume_ml > 0.9 * ball_ml);
  CHECK(volume_ml < 1.1 * ball_ml);
}
