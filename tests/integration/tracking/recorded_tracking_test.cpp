#include <doctest/doctest.h>

#include <cmath>

#include "core/tracking/bottom_line.h"
#include "core/tracking/time_offset.h"
#include "core/tracking/transform_graph.h"
#include "tests/support/recorded_sets.h"

using namespace sonoloft;
using sonoloft::test::recorded_set;

namespace {

TrackedSequence read(const std::filesystem::path& path) {
  auto sequence = read_tracked_sequence(path);
  if (!sequence) FAIL(sequence.error().message);
  return std::move(*sequence);
}

TimeOffset offset_of(const TrackedSequence& images, const TrackedSequence& poses) {
  PoseTrack track;
  for (const SequenceFrame& frame : poses.frames) track.add(frame.time, transform_between(frame, "Probe", "Reference"));
  const auto lines = bottom_lines(images.images);
  std::vector<TimedValue> seen;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i] && images.frames[i].image_ok) seen.push_back({images.frames[i].time, *lines[i]});
  }
  const auto offset = estimate_time_offset(seen, track);
  if (!offset) FAIL(offset.error().message);
  MESSAGE(seen.size() << " of " << lines.size() << " images: offset "
                      << static_cast<double>(offset->offset.count()) * 1e-6 << " ms, correlation "
                      << offset->correlation);
  return *offset;
}

/// The voxels around a point, weighted; nothing at the border and outside.
std::optional<double> sample(const ImageStack& volume, const Eigen::Vector3d& p_mm) {
  const Eigen::Vector3d index = (p_mm - volume.origin_mm).cwiseQuotient(volume.spacing_mm);
  const Eigen::Vector3d low = index.array().floor().matrix();
  for (int k = 0; k < 3; ++k) {
    if (low[k] < 0 || low[k] + 1 >= volume.dims[static_cast<std::size_t>(k)]) return std::nullopt;
  }
  const Eigen::Vector3d share = index - low;
  double value = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::size_t at = 0, stride = 1;
    for (int k = 0; k < 3; ++k) {
      const bool high = (corner >> k & 1) != 0;
      weight *= high ? share[k] : 1 - share[k];
      at += stride * (static_cast<std::size_t>(low[k]) + high);
      stride *= volume.dims[static_cast<std::size_t>(k)];
    }
    value += weight * volume.pixels[at];
  }
  return value;
}

}  // namespace

// PLUS's own answer for this recording is -64.8 ms.
TEST_CASE("tracking: the water tank's lag is found within 5 ms") {
  const auto video = recorded_set("tracked/WaterTankBottomTranslationVideoBuffer.igs.mha");
  const auto tracker = recorded_set("tracked/WaterTankBottomTranslationTrackerBuffer.igs.mha");
  if (!video || !tracker) return;
  const TimeOffset found = offset_of(read(*video), read(*tracker));
  CHECK(std::abs(static_cast<double>(found.offset.count()) * 1e-6 - -64.8) < 5);
}

TEST_CASE("tracking: so it is where images and poses are in one file, with frames lost") {
  const auto combined = recorded_set("tracked/WaterTankBottomTranslationCombined.igs.mha");
  if (!combined) return;
  const TrackedSequence sequence = read(*combined);
  const TimeOffset found = offset_of(sequence, sequence);
  CHECK(std::abs(static_cast<double>(found.offset.count()) * 1e-6 - -64.8) < 5);
}

TEST_CASE("tracking: the pixels of the spine phantom land where PLUS put them") {
  const auto frames = recorded_set("tracked/SpinePhantomFreehand.igs.mha");
  const auto reconstructed = recorded_set("tracked/SpinePhantomFreehandReconstructed.mha");
  if (!frames || !reconstructed) return;
  const TrackedSequence sequence = read(*frames);
  const auto volume = read_image_stack(*reconstructed);
  REQUIRE(volume);
  const auto config = read_plus_config(recorded_set("tracked/SpinePhantomFreehand_config.xml").value());
  REQUIRE(config);
  const auto [width, height, count] = sequence.images.dims;
  double n = 0, sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    TransformGraph graph;
    graph.set(*config);
    graph.set(sequence.frames[i]);
    const auto image_to_reference = graph.find("Image", "Reference");
    REQUIRE(image_to_reference);
    for (std::uint32_t v = 0; v < height; v += 2) {
      for (std::uint32_t u = 0; u < width; u += 2) {
        const auto there = sample(*volume, *image_to_reference * Eigen::Vector3d(u, v, 0));
        if (!there) continue;
        const double x = sequence.images.pixels[(std::size_t{i} * height + v) * width + u], y = *there;
        n += 1, sx += x, sy += y, sxx += x * x, syy += y * y, sxy += x * y;
      }
    }
  }
  REQUIRE(n > 1e5);
  const double correlation = (n * sxy - sx * sy) / std::sqrt((n * sxx - sx * sx) * (n * syy - sy * sy));
  MESSAGE(n << " pixels, correlation " << correlation);
  CHECK(correlation >= 0.97);
}
