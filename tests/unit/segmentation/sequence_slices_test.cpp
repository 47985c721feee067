#include "core/segmentation/sequence_slices.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/slice/section.h"
#include "tests/support/sequence_file.h"

using namespace sonoloft;
using test::Fields;
using test::frame_fields;

namespace {

constexpr int kSize = 40;

/// A disc of label 2 with radius 12 in the middle; 99 in the corners, which were not seen.
std::string disc() {
  std::string pixels;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const double r = std::hypot(x - 19.5, y - 19.5);
      pixels += static_cast<char>(r < 12 ? 2 : r > 24 ? 99 : 0);
    }
  return pixels;
}

std::string at_height(int z) {
  return "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(z) + " 0 0 0 1";
}

/// Four frames: a good one, one without a pose, one without an image, a good one.
TrackedSequence recorded() {
  Fields fields;
  for (int i = 0; i < 4; ++i) {
    for (const auto& field : frame_fields(i, at_height(10 * i), std::to_string(i), i == 1 ? "INVALID" : "OK"))
      fields.push_back(field);
    if (i == 2) fields.back().second = "INVALID";
  }
  const std::string image = disc();
  auto sequence = parse_tracked_sequence(test::meta_image("40 40 4", fields, image + image + image + image), "x");
  REQUIRE_MESSAGE(sequence, (sequence ? "" : sequence.error().message));
  return std::move(*sequence);
}

/// Pixels of 0.5 x 0.25 mm, the first one at (1, 2, 3) in the probe.
PlusConfig calibrated() {
  Eigen::Affine3d image_to_probe(Eigen::Translation3d(1, 2, 3));
  image_to_probe.scale(Eigen::Vector3d(0.5, 0.25, 1));
  return {{{"Image", "Probe", image_to_probe}}, std::nullopt};
}

SequenceReading in_tracker() {
  return {"Image", "Tracker", PixelMeaning::labels, 99};
}

SequenceSlices slices(const TrackedSequence& sequence, const PlusConfig& config, const SequenceReading& reading) {
  auto read = slices_of(sequence, config, reading);
  REQUIRE_MESSAGE(read, (read ? "" : read.error().message));
  return std::move(*read);
}

Label label_in(const TrackedSlice& slice, double x_mm, double y_mm) {
  const auto section = make_section(slice);
  REQUIRE(section);
  return label_at(*section, {x_mm, y_mm});
}

}  // namespace

TEST_CASE("sequence slices: label images become contours in mm; frames without image or pose are counted") {
  const SequenceSlices read = slices(recorded(), calibrated(), in_tracker());
  CHECK(read.without_image == 1);
  CHECK(read.without_pose == 1);
  REQUIRE(read.slices.size() == 2);
  const TrackedSlice& slice = read.slices[1];
  CHECK(slice.id == 3);
  CHECK(slice.time == std::chrono::seconds(3));
  CHECK(slice.image_to_reference.translation().isApprox(Eigen::Vector3d(1, 2, 33)));
  double area_mm2 = 0;
  for (const Contour& contour : slice.contours) {
    if (contour.label != 2) continue;
    for (std::uint32_t i = 0; i < contour.count; ++i) {
      const auto &a = slice.points[contour.first + i], &b = slice.points[contour.first + (i + 1) % contour.count];
      area_mm2 += 0.5 * (a.x() * b.y() - a.y() * b.x());
    }
  }
  CHECK(std::abs(area_mm2) == doctest::Approx(3.14159 * 12 * 12 * 0.5 * 0.25).epsilon(0.02));
  CHECK(label_in(slice, 0.5 * 19.5, 0.25 * 19.5) == 2);
  CHECK(label_in(slice, 0.5 * 19.5, 0.25 * 4) == kOutside);
  CHECK(label_in(slice, 0.5 * 0.2, 0.25 * 0.2) == kUnknown);    // the value of what was not seen
  CHECK(label_in(slice, 0.5 * -0.8, 0.25 * 19.5) == kUnknown);  // beyond the image
  CHECK(label_in(slice, 0.5 * -0.3, 0.25 * 19.5) == kOutside);  // still within its first pixel
}

TEST_CASE("sequence slices: nothing is said beyond the clip rectangle") {
  PlusConfig config = calibrated();
  config.clip = ClipRectangle{{0, 0}, {20, 40}};
  const TrackedSlice slice = slices(recorded(), config, in_tracker()).slices.front();
  CHECK(label_in(slice, 0.5 * 18, 0.25 * 19.5) == 2);
  CHECK(label_in(slice, 0.5 * 22, 0.25 * 19.5) == kUnknown);
}

TEST_CASE("sequence slices: few values are labels, many are brightness") {
  TrackedSequence sequence = recorded();
  CHECK(guess_meaning(sequence.images) == PixelMeaning::labels);
  for (std::size_t i = 0; i < sequence.images.pixels.size(); ++i)
    sequence.images.pixels[i] = static_cast<std::uint8_t>(i);
  CHECK(guess_meaning(sequence.images) == PixelMeaning::bmode);
}

TEST_CASE("sequence slices: what cannot be placed or seen is an error that names the cause") {
  const TrackedSequence sequence = recorded();
  const auto code = [&](const PlusConfig& config, const SequenceReading& reading) {
    const auto read = slices_of(sequence, config, reading);
    REQUIRE_FALSE(read);
    return read.error().code;
  };
  CHECK(code({}, in_tracker()) == ErrorCode::invalid_argument);
  CHECK(code(calibrated(), {"Image", "Reference", PixelMeaning::labels, {}}) == ErrorCode::invalid_argument);
  PlusConfig flat = calibrated();
  flat.transforms[0].matrix.linear().col(1) = flat.transforms[0].matrix.linear().col(0) * 1.001;
  flat.transforms[0].matrix.linear().col(2) = Eigen::Vector3d(0, 1, 1);
  CHECK(code(flat, in_tracker()) == ErrorCode::not_rigid);
  PlusConfig beyond = calibrated();
  beyond.clip = ClipRectangle{{40, 0}, {5, 5}};
  CHECK(code(beyond, in_tracker()) == ErrorCode::empty_input);
  TrackedSequence lost = sequence;
  for (SequenceFrame& frame : lost.frames) frame.transforms["ProbeToTracker"] = std::nullopt;
  CHECK(slices_of(lost, calibrated(), in_tracker()).error().code == ErrorCode::empty_input);
}
