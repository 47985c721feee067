// Slices that come as label masks, from the firmware to a session's callback.
#include <doctest/doctest.h>

#include "core/slice/section.h"
#include "tests/support/wire/loopback_bench.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

device_sim::SliceSource masked_slices(std::uint32_t count, bool with_field_of_view) {
  auto current = std::make_shared<OwnedWireSlice>();
  return [=, next = std::uint32_t{0}]() mutable -> const device_sim::AcquiredSlice* {
    if (next == count) return nullptr;
    *current = make_masked_slice(next++);
    if (!with_field_of_view) current->field_of_view.clear();
    return &current->view();
  };
}

// How many of the mask's pixels the slice has with another label.
int wrong_pixels(const TrackedSlice& slice, const OwnedWireSlice& sent) {
  const auto section = make_section(slice);
  REQUIRE(section);
  const auto& grid = sent.slice.mask_grid;
  const auto message = test_calibration();
  const double* calibration = message.image_to_probe;
  const Eigen::Vector2d pixel_mm(std::hypot(calibration[0], calibration[4]),
                                 std::hypot(calibration[1], calibration[5]));
  int at = 0, wrong = 0;
  for (const auto& run : sent.mask_runs) {
    for (int i = 0; i < run.count; ++i, ++at) {
      const Eigen::Vector2d pixel(grid.x_px + grid.step_px * static_cast<float>(at % grid.width),
                                  grid.y_px + grid.step_px * static_cast<float>(at / grid.width));
      wrong += label_at(*section, pixel.cwiseProduct(pixel_mm)) == run.label ? 0 : 1;
    }
  }
  return wrong;
}

}  // namespace

TEST_CASE("masks: every pixel arrives with its label, in mm, and beyond the grid nothing was seen") {
  device_sim::LoopbackDevice loopback(loopback_options(), masked_slices(20, false));
  auto session = open_session(loopback.port());
  CHECK(session->info().max_mask_runs == kTestLimits.max_mask_runs);
  Inbox inbox;
  REQUIRE(session->start({device::StreamMode::lossless, 16}, inbox.callbacks()));
  REQUIRE(inbox.wait_for(device::EventKind::end_of_data));
  session->stop();
  check_closed(session->ledger());
  const auto slices = inbox.slices();
  REQUIRE(slices.size() == 20);
  for (const auto& delivered : slices) {
    const auto sent = make_masked_slice(static_cast<std::uint32_t>(delivered->slice.id));
    CHECK(delivered->slice.field_of_view.size() == 4);
    CHECK(wrong_pixels(delivered->slice, sent) == 0);
    const auto section = make_section(delivered->slice);
    CHECK(section->border == kUnknown);
  }
}

TEST_CASE("masks: a field of view that comes with one is kept") {
  device_sim::LoopbackDevice loopback(loopback_options(), masked_slices(1, true));
  auto session = open_session(loopback.port());
  Inbox inbox;
  REQUIRE(session->start({device::StreamMode::lossless, 16}, inbox.callbacks()));
  REQUIRE(inbox.wait_for_slices(1));
  session->stop();
  const auto& corners = inbox.slices()[0]->slice.field_of_view;
  REQUIRE(corners.size() == 4);
  CHECK(corners[2].x() == doctest::Approx(640 * 0.2));
  CHECK(corners[2].y() == doctest::Approx(480 * 0.25));
}
