#include "device_sim/probe/simulated_probe.h"

#include <doctest/doctest.h>

#include <cstring>
#include <limits>
#include <numbers>
#include <string>

#include "device_sim/probe/phantoms/solid_phantom.h"
#include "tests/support/phantom_section.h"

namespace test = sonoloft::test;
using namespace sonoloft::device_sim;

namespace {

std::shared_ptr<const Phantom> organs() {
  static const auto phantom = std::make_shared<const SolidPhantom>(organs_phantom());
  return phantom;
}

std::shared_ptr<const Phantom> ball() {
  static const auto phantom = std::make_shared<const SolidPhantom>(std::vector<Solid>{sphere({10, 20, 30}, 35, 2)});
  return phantom;
}

std::vector<SimulatedFrame> run(const ProbeOptions& options, std::shared_ptr<const SectionSource> source,
                                const Trajectory& trajectory) {
  auto probe = SimulatedProbe::make(options, std::move(source), trajectory);
  REQUIRE_MESSAGE(probe.value, probe.error);
  std::vector<SimulatedFrame> frames;
  while (auto frame = probe.value->next()) frames.push_back(std::move(*frame));
  return frames;
}

Eigen::Isometry3d isometry(const sonoloft::protocol::Pose& pose) {
  return Eigen::Translation3d(pose.tx_mm, pose.ty_mm, pose.tz_mm) *
         Eigen::Quaterniond(pose.qw, pose.qx, pose.qy, pose.qz);
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_pose(const sonoloft::protocol::Pose& a, const sonoloft::protocol::Pose& b) {
  return a.qw == b.qw && a.qx == b.qx && a.qy == b.qy && a.qz == b.qz && a.tx_mm == b.tx_mm && a.ty_mm == b.ty_mm &&
         a.tz_mm == b.tz_mm && a.time_ns == b.time_ns && a.status == b.status;
}

/// Where only the poses matter.
class Nothing final : public SectionSource {
 public:
  Eigen::AlignedBox3d bounds() const override { return ball()->bounds(); }
  PhantomSection section(const Eigen::Isometry3d&) const override { return {}; }
};
std::shared_ptr<const SectionSource> nothing() {
  return std::make_shared<const Nothing>();
}

/// Trajectory of one pose, held `count` times.
Trajectory held(std::size_t count) {
  return Trajectory(count, linear_sweep(ball()->bounds(), {.slices = 1, .standoff_mm = {}})[0]);
}

}  // namespace

TEST_CASE("probe: pixels through calibration and pose come back to the body they were taken of") {
  const Trajectory trajectory = freehand_sweep(ball()->bounds(), {.slices = 20, .standoff_mm = {}}, Hand{});
  ProbeOptions options;
  options.sector = covering_sector(ball()->bounds(), trajectory);
  auto probe = SimulatedProbe::make(options, ball(), trajectory);
  REQUIRE(probe.value);
  const Eigen::Matrix<double, 3, 4> image_to_probe = probe.value->image_to_probe();
  std::size_t points = 0;
  double off_body = 0, off_truth = 0;
  for (std::uint64_t i = 0; i < 20; ++i) {
    const auto frame = probe.value->next();
    REQUIRE(frame);
    CHECK(frame->index == i);
    CHECK(frame->time_ns == static_cast<std::uint64_t>(std::llround(static_cast<double>(i) * 1e9 / 30)));
    CHECK(frame->pose.time_ns == frame->time_ns);
    for (const sonoloft::protocol::Point& p : frame->points) {
      const Eigen::Vector3d probe_mm = image_to_probe * Eigen::Vector4d(p.x_px, p.y_px, 0, 1);
      const Eigen::Vector3d at = isometry(frame->pose) * probe_mm;
      off_body = std::max(off_body, std::abs((at - Eigen::Vector3d(10, 20, 30)).norm() - 35));
      off_truth = std::max(
          off_truth, (at - frame->true_image_to_reference * Eigen::Vector3d(0.2 * p.x_px, 0.2 * p.y_px, 0)).norm());
      ++points;
    }
    for (const sonoloft::protocol::Point& p : frame->field_of_view) {
      CHECK(p.x_px >= -1e-3f);
      CHECK(p.y_px >= -1e-3f);
    }
  }
  CHECK(!probe.value->next());
  CHECK(points > 2000);
  MESSAGE(points << " points, at most " << off_body << " mm off the body");
  CHECK(off_body < 1e-3);
  CHECK(off_truth < 1e-9);
}

TEST_CASE("probe: a frame's view names the frame's own arrays") {
  const auto frames = run({}, organs(), linear_sweep(organs()->bounds(), {.slices = 3, .standoff_mm = {}}));
  const AcquiredSlice view = frames[1].view();
  CHECK(view.points.data() == frames[1].points.data());
  CHECK(view.contours.size() == frames[1].contours.size());
  CHECK(view.contours.size() >= 2);
  CHECK(view.time_ns == frames[1].time_ns);
  std::uint32_t next = 0;
  for (const sonoloft::protocol::Contour& c : view.contours) {
    CHECK(c.first == next);
    next += c.count;
  }
  CHECK(next == view.points.size());
}

TEST_CASE("probe: the same seed gives the same bytes, another seed others") {
  const Trajectory trajectory = freehand_sweep(organs()->bounds(), {.slices = 15, .standoff_mm = {}}, Hand{});
  ProbeOptions options;
  options.sector = covering_sector(organs()->bounds(), trajectory);
  options.shadowing = {static_cast<Label>(Organ::vessel)};
  options.tracker_rms_mm = 0.3;
  options.tracker_rms_deg = 0.2;
  options.dropout_share = 0.2;
  options.contour_rms_mm = 0.4;
  options.tracker_bias_mm = 1;
  options.wrong_share = 0.03;
  options.contact_lost_share = 0.1;
  const auto one = run(options, organs(), trajectory), again = run(options, organs(), trajectory);
  options.seed = 2;
  const auto other = run(options, organs(), trajectory);
  bool points_differ = false, poses_differ = false;
  for (std::size_t i = 0; i < 15; ++i) {
    CHECK(same_bytes(one[i].points, again[i].points));
    CHECK(same_bytes(one[i].contours, again[i].contours));
    CHECK(same_bytes(one[i].field_of_view, again[i].field_of_view));
    CHECK(same_pose(one[i].pose, again[i].pose));
    points_differ |= !same_bytes(one[i].points, other[i].points);
    poses_differ |= !same_pose(one[i].pose, other[i].pose);
  }
  CHECK(points_differ);
  CHECK(poses_differ);
}

TEST_CASE("probe: tracker noise has the asked size, about the marker") {
  ProbeOptions options;
  options.tracker_rms_mm = 0.4;
  options.tracker_rms_deg = 0.7;
  constexpr std::size_t kImages = 3000;
  const Trajectory trajectory = held(kImages);
  const auto frames = run(options, nothing(), trajectory);
  const Eigen::Isometry3d truth = trajectory[0] * options.face_to_probe.inverse();
  double mm2 = 0, deg2 = 0;
  for (const SimulatedFrame& frame : frames) {
    const Eigen::Isometry3d got = isometry(frame.pose);
    mm2 += (got.translation() - truth.translation()).squaredNorm();
    const double angle = Eigen::AngleAxisd(truth.linear().transpose() * got.linear()).angle();
    deg2 += std::pow(angle * 180 / std::numbers::pi, 2);
    CHECK(frame.pose.error_mm == 0.4f);
  }
  CHECK(std::sqrt(mm2 / kImages) == doctest::Approx(0.4).epsilon(0.05));
  CHECK(std::sqrt(deg2 / kImages) == doctest::Approx(0.7).epsilon(0.05));
}

TEST_CASE("probe: a bias stays below its limit and changes slowly") {
  ProbeOptions options;
  options.tracker_bias_mm = 2;
  constexpr std::size_t kImages = 4000;
  const Trajectory trajectory = held(kImages);
  const auto frames = run(options, nothing(), trajectory);
  const Eigen::Vector3d truth = (trajectory[0] * options.face_to_probe.inverse()).translation();
  double longest = 0, sum = 0, steps = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), last = isometry(frames[0].pose).translation() - truth;
  for (const SimulatedFrame& frame : frames) {
    const Eigen::Vector3d off = isometry(frame.pose).translation() - truth;
    longest = std::max(longest, off.norm());
    sum += off.norm() / kImages;
    steps += (off - last).norm() / kImages;
    mean += off / kImages;
    last = off;
  }
  MESSAGE("mean length " << sum << " mm, longest " << longest << " mm, from image to image " << steps << " mm");
  CHECK(longest < 2);
  CHECK(longest > 1.7);
  CHECK(sum == doctest::Approx(1.35).epsilon(0.1));
  CHECK(steps < 0.3 * sum);
  CHECK(mean.norm() < 0.5 * sum);  // it wanders
}

TEST_CASE("probe: contact is lost at the edges for the asked share of the beams, for a while") {
  ProbeOptions options;
  options.sector = kConvexArray;
  options.contact_lost_share = 0.1;
  constexpr std::size_t kImages = 4000;
  const double whole_mm2 = test::loop_area(field_of_view(kConvexArray, {}, {}));
  double seen = 0, steps = 0, last = 0;
  std::size_t narrow = 0;
  const auto frames = run(options, nothing(), held(kImages));
  for (const SimulatedFrame& frame : frames) {
    std::vector<Eigen::Vector2d> view;
    for (const sonoloft::protocol::Point& p : frame.field_of_view) view.emplace_back(0.2 * p.x_px, 0.2 * p.y_px);
    const double share = test::loop_area(view) / whole_mm2;
    seen += share / kImages;
    if (last > 0) steps += std::abs(share - last) / kImages;
    narrow += share < 0.7;
    last = share;
  }
  MESSAGE("seen " << seen << " on average, " << narrow << " images of less than 0.7; from image to image " << steps);
  CHECK(seen == doctest::Approx(0.9).epsilon(0.03));
  CHECK(narrow > kImages / 50);
  CHECK(narrow < kImages / 5);
  CHECK(steps < 0.05);
}

TEST_CASE("probe: dropouts have the asked share and length, are counted and keep the last good pose") {
  ProbeOptions options;
  options.dropout_share = 0.2;
  options.dropout_images = 5;
  constexpr std::size_t kImages = 20'000;
  auto probe = SimulatedProbe::make(options, nothing(), held(kImages));
  REQUIRE(probe.value);
  std::size_t dropped = 0, stretches = 0;
  sonoloft::protocol::Pose last;
  while (const auto frame = probe.value->next()) {
    const bool ok = frame->pose.status == PoseStatus::ok;
    if (!ok && last.status == PoseStatus::ok) ++stretches;
    if (!ok) CHECK(frame->pose.time_ns == last.time_ns);
    if (ok) CHECK(frame->pose.time_ns == frame->time_ns);
    dropped += !ok;
    last = frame->pose;
  }
  MESSAGE(dropped << " of " << kImages << " poses dropped in " << stretches << " stretches");
  CHECK(probe.value->dropped_poses() == dropped);
  CHECK(static_cast<double>(dropped) / kImages == doctest::Approx(0.2).epsilon(0.1));
  CHECK(static_cast<double>(dropped) / static_cast<double>(stretches) == doctest::Approx(5).epsilon(0.1));
}

TEST_CASE("probe: one option's noise does not shift another's") {
  const Trajectory trajectory = held(400);
  ProbeOptions options;
  options.dropout_share = 0.3;
  const auto quiet = run(options, nothing(), trajectory);
  options.tracker_rms_mm = 1;
  options.contour_rms_mm = 1;
  options.tracker_bias_mm = 1;
  options.sector = kConvexArray;
  options.contact_lost_share = 0.1;
  const auto noisy = run(options, nothing(), trajectory);
  for (std::size_t i = 0; i < 400; ++i) CHECK(quiet[i].pose.status == noisy[i].pose.status);
  options.tracker_rms_mm = 0;
  options.wrong_share = 0.05;
  const auto wrong = run(options, nothing(), trajectory);
  for (std::size_t i = 0; i < 400; ++i) CHECK(same_bytes(noisy[i].field_of_view, wrong[i].field_of_view));
}

TEST_CASE("probe: contour noise has the asked size, is smooth, and moves shared points together") {
  const auto halves = std::make_shared<const SolidPhantom>(std::vector<Solid>{
      sphere({10, 20, 30}, 35, 2), box(Eigen::Isometry3d(Eigen::Translation3d(40, 20, 30)), {30, 30, 30}, 3)});
  ProbeOptions options;
  const auto clean = run(options, halves, held(60));
  options.contour_rms_mm = 0.5;
  options.contour_correlation_mm = 10;
  const auto noisy = run(options, halves, held(60));
  double squares = 0, steps = 0;
  std::size_t count = 0, shared = 0;
  for (std::size_t i = 0; i < 60; ++i) {
    REQUIRE(clean[i].points.size() == noisy[i].points.size());
    Eigen::Vector2d last(0, 0);
    for (std::size_t k = 0; k < clean[i].points.size(); ++k) {
      const sonoloft::protocol::Point &c = clean[i].points[k], &n = noisy[i].points[k];
      const Eigen::Vector2d off = 0.2 * Eigen::Vector2d(n.x_px - c.x_px, n.y_px - c.y_px);
      squares += off.squaredNorm();
      if (k > 0) steps += (off - last).squaredNorm();
      last = off;
      ++count;
      for (std::size_t j = 0; i == 0 && j < k; ++j) {
        if (clean[i].points[j].x_px != c.x_px || clean[i].points[j].y_px != c.y_px) continue;
        ++shared;
        CHECK(noisy[i].points[j].x_px == n.x_px);
        CHECK(noisy[i].points[j].y_px == n.y_px);
      }
    }
  }
  const double rms = std::sqrt(squares / static_cast<double>(count));
  const double step = std::sqrt(steps / static_cast<double>(count));
  MESSAGE("rms " << rms << " mm, from point to point " << step << " mm; " << shared << " shared points");
  CHECK(rms == doctest::Approx(0.5).epsilon(0.1));
  CHECK(step < 0.3 * rms);
  CHECK(shared > 20);
}

TEST_CASE("probe: a narrow sector sends what it sees a part of, and not what it does not see") {
  const Trajectory trajectory = rotation_sweep(organs()->bounds(), {.slices = 12, .standoff_mm = 5});
  ProbeOptions options;
  const auto all = run(options, organs(), trajectory);
  options.sector = Sector{4, 62, 30 * std::numbers::pi / 180};
  const auto narrow = run(options, organs(), trajectory);
  std::size_t sent = 0, taken = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    CHECK(!narrow[i].field_of_view.empty());
    std::vector<Eigen::Vector2d> view;
    for (const sonoloft::protocol::Point& p : narrow[i].field_of_view) view.emplace_back(p.x_px, p.y_px);
    for (const sonoloft::protocol::Contour& c : narrow[i].contours) {
      std::vector<Eigen::Vector2d> loop;
      for (std::uint32_t k = 0; k < c.count; ++k)
        loop.emplace_back(narrow[i].points[c.first + k].x_px, narrow[i].points[c.first + k].y_px);
      CHECK(overlaps(loop, view));
    }
    sent += narrow[i].contours.size();
    taken += all[i].contours.size();
  }
  MESSAGE(sent << " of " << taken << " contours sent");
  CHECK(sent > 0);
  CHECK(sent < taken);
}

TEST_CASE("probe: options out of range are refused and say why") {
  const Trajectory trajectory = held(1);
  const auto refused = [&](const char* word, auto change) {
    ProbeOptions options;
    change(options);
    const auto made = SimulatedProbe::make(options, ball(), trajectory);
    INFO(made.error);
    CHECK(!made.value);
    CHECK(made.error.find(word) != std::string::npos);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused("rate", [](ProbeOptions& o) { o.rate_hz = 0; });
  refused("rate", [&](ProbeOptions& o) { o.rate_hz = nan; });
  refused("pixel", [](ProbeOptions& o) { o.pixel_mm = -0.2; });
  refused("face_to_probe", [](ProbeOptions& o) { o.face_to_probe.linear() *= 2; });
  refused("sector", [](ProbeOptions& o) { o.sector = Sector{50, 40, 0.5}; });
  refused("sector", [](ProbeOptions& o) { o.sector = Sector{5, 40, 3}; });
  refused("shadows", [](ProbeOptions& o) { o.shadowing = {1}; });
  refused("wrong labels", [](ProbeOptions& o) { o.wrong_share = 0.1; });
  refused("lost contact", [](ProbeOptions& o) {
    o.sector = kConvexArray;
    o.contact_lost_share = 0.7;
  });
  refused("wander", [](ProbeOptions& o) { o.wander_images = 0; });
  refused("tracker", [](ProbeOptions& o) { o.tracker_bias_mm = -1; });
  refused("tracker", [&](ProbeOptions& o) { o.tracker_rms_mm = nan; });
  refused("dropouts", [](ProbeOptions& o) { o.dropout_share = 0.9; });
  refused("dropouts", [](ProbeOptions& o) { o.dropout_images = 0; });
  refused("contours", [](ProbeOptions& o) { o.contour_correlation_mm = 0; });
  CHECK(SimulatedProbe::make({}, nullptr, trajectory).error.find("phantom") != std::string::npos);
  Trajectory bent = trajectory;
  bent[0].linear()(0, 0) = nan;
  CHECK(SimulatedProbe::make({}, ball(), bent).error.find("pose 0") != std::string::npos);
}
