#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "protocol/accept.h"
#include "protocol/record.h"
#include "protocol/schema_hash.h"
#include "protocol/slice.h"
#include "protocol/slice_codec.h"

namespace sonoloft::test {

/// A slice that owns its arrays.
struct OwnedWireSlice {
  std::vector<protocol::Point> points, field_of_view;
  std::vector<protocol::Contour> contours;
  std::vector<protocol::MaskRun> mask_runs;
  protocol::Slice slice;

  const protocol::Slice& view() {
    slice.points = points;
    slice.contours = contours;
    slice.field_of_view = field_of_view;
    slice.mask_runs = mask_runs;
    return slice;
  }
};

inline constexpr protocol::SliceLimits kTestLimits{4096, 64, 9, 2048, 1u << 16};
inline constexpr std::uint32_t kTestCalibrationId = 7;

/// A sound slice, another one for every seed: rings of points, holes and unknown among the labels, any pose.
inline OwnedWireSlice make_wire_slice(std::uint32_t seed, std::uint32_t contours = 5, std::uint32_t points_each = 40) {
  std::mt19937 random(seed);
  const auto unit = [&random] { return static_cast<double>(random()) / 4294967296.0; };
  OwnedWireSlice owned;
  for (std::uint32_t c = 0; c < contours; ++c) {
    const bool hole = random() % 5 == 0;
    const auto label = static_cast<protocol::WireLabel>(random() % 7 == 0 ? protocol::kUnknownLabel : 1 + random() % 9);
    owned.contours.push_back({static_cast<std::uint32_t>(owned.points.size()), points_each, label,
                              hole ? protocol::kHoleFlag : std::uint16_t{0}});
    const double x = 600 * unit(), y = 400 * unit(), r = 5 + 40 * unit();
    for (std::uint32_t i = 0; i < points_each; ++i) {
      const double angle = 2 * 3.14159265358979 * i / points_each;
      owned.points.push_back(
          {static_cast<float>(x + r * std::cos(angle)), static_cast<float>(y + r * std::sin(angle))});
    }
  }
  owned.field_of_view = {{0, 0}, {640, 0}, {640, 480}, {0, 480}};
  protocol::Pose& pose = owned.slice.pose;
  std::array<double, 4> q{unit() - 0.5, unit() - 0.5, unit() - 0.5, unit() + 0.1};
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  pose = {q[3] / norm, q[0] / norm, q[1] / norm, q[2] / norm, 100 * unit(), 100 * unit(), 100 * unit()};
  pose.error_mm = 0.25f;
  pose.time_ns = 1'000'000'000ull + seed * 16'666'667ull;
  pose.status = seed % 10 == 9 ? protocol::PoseStatus::out_of_view : protocol::PoseStatus::ok;
  owned.slice.time_ns = pose.time_ns + 2'000'000;
  owned.slice.calibration_id = kTestCalibrationId;
  return owned;
}

/// A sound slice with a mask, another one for every seed.
inline OwnedWireSlice make_masked_slice(std::uint32_t seed, std::uint16_t width = 60, std::uint16_t height = 40) {
  std::mt19937 random(seed);
  OwnedWireSlice owned = make_wire_slice(seed, 0);
  owned.slice.mask_grid = {-3.5f, 2, 4, width, height};
  for (std::uint32_t left = std::uint32_t{width} * height; left > 0; left -= owned.mask_runs.back().count) {
    const auto label = static_cast<protocol::WireLabel>(random() % 7 == 0 ? protocol::kUnknownLabel : random() % 10);
    const auto count = static_cast<std::uint32_t>(1 + random() % 100);
    owned.mask_runs.push_back({static_cast<std::uint16_t>(std::min(left, count)), label});
  }
  return owned;
}

/// Memory that starts on 64 bytes, as records need it.
class AlignedBytes {
 public:
  explicit AlignedBytes(std::size_t size) : blocks_((size + 63) / 64), size_(size) {}
  std::span<std::byte> bytes() { return std::as_writable_bytes(std::span(blocks_)).first(size_); }
  std::span<std::byte> first(std::size_t n) { return bytes().first(n); }

 private:
  struct alignas(64) Block {
    std::byte bytes[64];
  };
  std::vector<Block> blocks_;
  std::size_t size_;
};

inline protocol::Agreement test_agreement(std::uint32_t session_id = 0x51DE0001) {
  return {protocol::kVersion.minor, protocol::kSchemaHash, session_id, 1u << 20, kTestLimits};
}

/// A complete record of a slice, as it leaves a device.
inline std::vector<std::byte> make_record(const protocol::Slice& slice, std::uint64_t seq = 0,
                                          std::uint32_t session_id = 0x51DE0001) {
  AlignedBytes buffer(static_cast<std::size_t>(protocol::max_record_len(slice)));
  const std::size_t len = protocol::encode_slice(slice, {seq, session_id, protocol::kVersion.minor}, buffer.bytes());
  protocol::seal_record(buffer.first(len), 3, 2, 16);
  return {buffer.bytes().begin(), buffer.bytes().begin() + static_cast<std::ptrdiff_t>(len)};
}

inline bool same(const protocol::Slice& a, const protocol::Slice& b) {
  const auto same_points = [](std::span<const protocol::Point> p, std::span<const protocol::Point> q) {
    return std::equal(p.begin(), p.end(), q.begin(), q.end(),
                      [](const auto& x, const auto& y) { return x.x_px == y.x_px && x.y_px == y.y_px; });
  };
  const auto& p = a.pose;
  const auto& q = b.pose;
  return a.time_ns == b.time_ns && a.calibration_id == b.calibration_id && same_points(a.points, b.points) &&
         same_points(a.field_of_view, b.field_of_view) &&
         std::equal(a.contours.begin(), a.contours.end(), b.contours.begin(), b.contours.end(),
                    [](const auto& x, const auto& y) {
                      return x.first == y.first && x.count == y.count && x.label == y.label && x.flags == y.flags;
                    }) &&
         std::equal(a.mask_runs.begin(), a.mask_runs.end(), b.mask_runs.begin(), b.mask_runs.end(),
                    [](const auto& x, const auto& y) { return x.count == y.count && x.label == y.label; }) &&
         a.mask_grid.x_px == b.mask_grid.x_px && a.mask_grid.y_px == b.mask_grid.y_px &&
         a.mask_grid.step_px == b.mask_grid.step_px && a.mask_grid.width == b.mask_grid.width &&
         a.mask_grid.height == b.mask_grid.height && p.qw == q.qw && p.qx == q.qx && p.qy == q.qy && p.qz == q.qz &&
         p.tx_mm == q.tx_mm && p.ty_mm == q.ty_mm && p.tz_mm == q.tz_mm && p.time_ns == q.time_ns &&
         p.error_mm == q.error_mm && p.status == q.status;
}

}  // namespace sonoloft::test
