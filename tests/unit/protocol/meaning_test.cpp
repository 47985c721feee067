#include <doctest/doctest.h>

#include <functional>
#include <limits>

#include "tests/support/wire/wire_slices.h"

using namespace sonoloft::protocol;
using namespace sonoloft::test;

namespace {

struct Case {
  const char* what;
  SliceFault fault;
  std::function<void(OwnedWireSlice&)> spoil;
};

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

const Case kCases[] = {
    {"too many points", SliceFault::too_many, [](auto& s) { s.points.resize(kTestLimits.max_points + 1); }},
    {"too many contours", SliceFault::too_many, [](auto& s) { s.contours.resize(kTestLimits.max_contours + 1); }},
    {"too long a field of view", SliceFault::too_many,
     [](auto& s) { s.field_of_view.resize(kTestLimits.max_points + 1); }},
    {"a point that is no number", SliceFault::non_finite, [](auto& s) { s.points[17].y_px = kNan; }},
    {"a corner at infinity", SliceFault::non_finite,
     [](auto& s) { s.field_of_view[2].x_px = std::numeric_limits<float>::infinity(); }},
    {"an infinite translation", SliceFault::non_finite, [](auto& s) { s.slice.pose.tz_mm = kInfinity; }},
    {"an error estimate that is no number", SliceFault::non_finite, [](auto& s) { s.slice.pose.error_mm = kNan; }},
    {"a quaternion of length 0", SliceFault::quaternion,
     [](auto& s) { s.slice.pose.qw = s.slice.pose.qx = s.slice.pose.qy = s.slice.pose.qz = 0; }},
    {"a quaternion 0.2 % too long", SliceFault::quaternion,
     [](auto& s) {
       for (double* q : {&s.slice.pose.qw, &s.slice.pose.qx, &s.slice.pose.qy, &s.slice.pose.qz}) *q *= 1.002;
     }},
    {"a pose status of a later version", SliceFault::pose_status,
     [](auto& s) { s.slice.pose.status = static_cast<PoseStatus>(6); }},
    {"a contour of 2 points", SliceFault::short_contour, [](auto& s) { s.contours[1].count = 2; }},
    {"a contour of no points", SliceFault::short_contour, [](auto& s) { s.contours[4].count = 0; }},
    {"a gap between contours", SliceFault::not_contiguous, [](auto& s) { ++s.contours[2].first; }},
    {"contours that overlap", SliceFault::not_contiguous, [](auto& s) { --s.contours[2].first; }},
    {"a contour that runs over the end", SliceFault::not_contiguous, [](auto& s) { ++s.contours[4].count; }},
    {"a count that wraps around", SliceFault::not_contiguous, [](auto& s) { s.contours[4].count = 0xFFFFFFFF; }},
    {"points without a contour", SliceFault::not_contiguous,
     [](auto& s) {
       s.points.push_back({1, 1});
     }},
    {"a label over the limit", SliceFault::bad_label, [](auto& s) { s.contours[0].label = 10; }},
    {"a label just below unknown", SliceFault::bad_label, [](auto& s) { s.contours[0].label = 0xFFFE; }},
    {"outside that is no hole", SliceFault::bad_label,
     [](auto& s) {
       s.contours[3].label = 0;
       s.contours[3].flags = 0;
     }},
    {"a flag of a later version", SliceFault::bad_label, [](auto& s) { s.contours[3].flags |= 2; }},
    {"a field of view of 2 corners", SliceFault::field_of_view, [](auto& s) { s.field_of_view.resize(2); }},
};

const Case kMaskCases[] = {
    {"contours beside it", SliceFault::mask,
     [](auto& s) {
       s.points = {{1, 1}, {2, 1}, {2, 2}}, s.contours = {{0, 3, 1, 0}};
     }},
    {"too many runs", SliceFault::too_many,
     [](auto& s) {
       s.mask_runs.assign(kTestLimits.max_mask_runs + 1, {1, 1});
     }},
    {"too many pixels", SliceFault::too_many, [](auto& s) { s.slice.mask_grid.height = 0xFFFF; }},
    {"runs that end early", SliceFault::mask, [](auto& s) { s.mask_runs.pop_back(); }},
    {"runs that go on", SliceFault::mask,
     [](auto& s) {
       s.mask_runs.push_back({1, 0});
     }},
    {"a run of no pixels", SliceFault::mask,
     [](auto& s) {
       s.mask_runs.insert(s.mask_runs.begin() + 3, {0, 1});
     }},
    {"a label over the limit", SliceFault::bad_label, [](auto& s) { s.mask_runs[2].label = 10; }},
    {"a grid without columns", SliceFault::mask, [](auto& s) { s.slice.mask_grid.width = 0; }},
    {"pixels of no size", SliceFault::mask, [](auto& s) { s.slice.mask_grid.step_px = 0; }},
    {"pixels of a negative size", SliceFault::mask, [](auto& s) { s.slice.mask_grid.step_px = -1; }},
    {"a size that is no number", SliceFault::non_finite, [](auto& s) { s.slice.mask_grid.step_px = kNan; }},
    {"a corner at infinity", SliceFault::non_finite,
     [](auto& s) { s.slice.mask_grid.x_px = std::numeric_limits<float>::infinity(); }},
    {"a field of view of 1 corner", SliceFault::field_of_view, [](auto& s) { s.field_of_view.resize(1); }},
};

}  // namespace

TEST_CASE("meaning: of a mask, too, each rule has its own fault") {
  for (const Case& c : kMaskCases) {
    auto owned = make_masked_slice(3);
    REQUIRE(check_slice(owned.view(), kTestLimits) == SliceFault::none);
    c.spoil(owned);
    CHECK_MESSAGE(check_slice(owned.view(), kTestLimits) == c.fault, c.what);
  }
}

TEST_CASE("meaning: who has no masks takes none") {
  auto owned = make_masked_slice(3);
  CHECK(check_slice(owned.view(), {4096, 64, 9}) == SliceFault::too_many);
}

TEST_CASE("meaning: a sound slice has no fault, with and without contours and field of view") {
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    auto owned = make_wire_slice(seed, seed % 9);
    if (seed % 2 == 0) owned.field_of_view.clear();
    CHECK(check_slice(owned.view(), kTestLimits) == SliceFault::none);
  }
}

TEST_CASE("meaning: every broken rule is found and called by its name") {
  for (const Case& c : kCases) {
    CAPTURE(c.what);
    auto owned = make_wire_slice(4);
    c.spoil(owned);
    CHECK(check_slice(owned.view(), kTestLimits) == c.fault);
  }
}

TEST_CASE("meaning: a hole may say label 0") {
  auto owned = make_wire_slice(4);
  owned.contours[3].label = 0;
  owned.contours[3].flags = kHoleFlag;
  CHECK(check_slice(owned.view(), kTestLimits) == SliceFault::none);
}
