#include "core/methods/straight_skeleton/straight_skeleton.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <set>

#include "core/methods/medial_axis/medial_axis.h"
#include "core/methods/network/data_box.h"
#include "core/slice/mask/label_mask.h"
#include "core/slice/section.h"
#include "tests/support/mesh/contour_section.h"
#include "tests/support/planes.h"
#include "tests/support/stacks/stack_slices.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Without fairing. Checked, with it and without: closed, and on every patch the slice's own contours.
ContourSurfaces surfaces(const std::vector<TrackedSlice>& slices) {
  for (const bool fairing : {true, false}) {
    auto made = straight_skeleton(slices, {fairing, 2});
    if (!made) FAIL(made.error().message);
    const ContourSection section = section_with(slices, *made);
    MESSAGE(made->triangles.size(), " triangles, ", section.text());
    CHECK(section.exact());
    if (!fairing) return std::move(*made);
  }
  return {};
}

/// A patch of this field of view; empty: the whole plane.
TrackedSlice patch(const Eigen::Isometry3d& frame, const Loop2d& view,
                   const std::vector<std::pair<Loop2d, Label>>& loops) {
  TrackedSlice slice;
  slice.image_to_reference = frame;
  slice.field_of_view = view;
  for (const auto& [loop, label] : loops) add_loop(slice, loop, label);
  return slice;
}

Eigen::Isometry3d level(double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(0, 0, z));
}

Loop2d square(double half) {
  return rectangle({-half, -half}, {half, half});
}

/// The label of a point that lies on no surface: the one that winds around it.
Label label_of(const ContourSurfaces& s, const Vector3d& p) {
  std::map<Label, double> turns;
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    const Vector3d a = s.positions[s.triangles[t][0]] - p, b = s.positions[s.triangles[t][1]] - p,
                   c = s.positions[s.triangles[t][2]] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    const double angle =
        2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
    turns[s.label_back[t]] += angle;
    turns[s.label_front[t]] -= angle;
  }
  for (const auto& [label, angle] : turns)
    if (label != kOutside && angle > 2 * std::numbers::pi) return label;
  return kOutside;
}

/// How many surfaces of a label hang together.
std::size_t parts(const ContourSurfaces& s, Label label) {
  std::vector<std::uint32_t> root(s.positions.size());
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  std::set<std::uint32_t> used;
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    if (s.label_front[t] != label && s.label_back[t] != label) continue;
    for (const std::uint32_t v : s.triangles[t]) {
      root[find(v)] = find(s.triangles[t][0]);
      used.insert(v);
    }
  }
  std::set<std::uint32_t> roots;
  for (const std::uint32_t v : used) roots.insert(find(v));
  return roots.size();
}

/// A patch with a convex field of view, as its distance is written down.
struct ConvexPatch {
  Section section;
  Loop2d view;
  Eigen::Isometry3d to_image;

  explicit ConvexPatch(const TrackedSlice& slice)
      : section(*make_section(slice)),
        view(slice.field_of_view),
        to_image(slice.image_to_reference.inverse(Eigen::Isometry)) {}
  double distance(const Vector3d& p) const {
    const Vector3d q = to_image * p;
    double most = std::abs(q.z());
    for (std::size_t i = 0; i < view.size(); ++i) {
      const Vector2d way = (view[(i + 1) % view.size()] - view[i]).normalized();
      most = std::max(most, (q.head<2>() - view[i]).dot(Vector2d(way.y(), -way.x())));
    }
    return most;
  }
  /// The nearest point of the patch to the upright foot.
  Label label(const Vector3d& p) const {
    const Vector2d q = (to_image * p).head<2>();
    Vector2d nearest = q, middle = Vector2d::Zero();
    double least = std::numeric_limits<double>::infinity();
    bool within = true;
    for (std::size_t i = 0; i < view.size(); ++i) {
      const Vector2d &a = view[i], &b = view[(i + 1) % view.size()], way = b - a;
      middle += a / static_cast<double>(view.size());
      within &= way.x() * (q - a).y() - way.y() * (q - a).x() >= 0;
      const Vector2d at = a + std::clamp((q - a).dot(way) / way.squaredNorm(), 0.0, 1.0) * way;
      if ((at - q).norm() < least) least = (at - q).norm(), nearest = at;
    }
    return label_at(section, within ? q : Vector2d(nearest + 1e-7 * (middle - nearest)));
  }
};

/// What fronts say of a point; nothing where two that differ arrive nearly together.
std::optional<Label> label_by_fronts(const std::vector<ConvexPatch>& patches, const Eigen::AlignedBox3d& box,
                                     const Vector3d& p) {
  const double wall = std::min((p - box.min()).minCoeff(), (box.max() - p).minCoeff());
  std::vector<std::pair<double, Label>> arrivals{{wall, kOutside}};
  for (const ConvexPatch& of : patches) arrivals.emplace_back(of.distance(p), of.label(p));
  std::ranges::sort(arrivals);
  for (std::size_t i = 1; i < arrivals.size() && arrivals[i].first - arrivals[0].first < 1e-2; ++i)
    if (arrivals[i].second != arrivals[0].second) return std::nullopt;
  return arrivals[0].second;
}

/// In how many points of a box the surfaces say something else than the fronts.
int errors_among(const std::vector<TrackedSlice>& slices, const ContourSurfaces& s, const Vector3d& low,
                 const Vector3d& high) {
  std::vector<ConvexPatch> patches;
  std::vector<Section> sections;
  for (const TrackedSlice& slice : slices) sections.push_back(patches.emplace_back(slice).section);
  const Eigen::AlignedBox3d box = network::box_around(sections);
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  int errors = 0, sure = 0, labelled = 0;
  for (int i = 0; i < 300; ++i) {
    const Vector3d part(uniform(rng), uniform(rng), uniform(rng)), p = low + part.cwiseProduct(high - low);
    const auto label = label_by_fronts(patches, box, p);
    if (!label) continue;
    ++sure;
    labelled += *label != kOutside;
    errors += label_of(s, p) != *label;
  }
  MESSAGE(sure, " points, ", labelled, " with a label, ", errors, " errors");
  CHECK(labelled > 20);
  return errors;
}

}  // namespace

TEST_CASE("straight-skeleton: with full planes it is the medial axis") {
  std::mt19937 rng(7);
  for (const int count : {1, 4, 7}) {
    std::vector<TrackedSlice> slices;
    for (int i = 0; i < count; ++i)
      slices.push_back(patch(random_frame(rng, 3), {}, {{circle({1, 2}, 12, 31), 1}, {circle({0, 3}, 5, 17), 2}}));
    const ContourSurfaces skeleton = surfaces(slices), axis = *medial_axis(slices, {false, 2});
    REQUIRE(skeleton.positions.size() == axis.positions.size());
    CHECK(skeleton.triangles.size() == axis.triangles.size());
    double farthest = 0;
    for (const Vector3d& p : skeleton.positions) {
      double least = std::numeric_limits<double>::infinity();
      for (const Vector3d& q : axis.positions) least = std::min(least, (p - q).norm());
      farthest = std::max(farthest, least);
    }
    MESSAGE(skeleton.positions.size(), " vertices, farthest ", farthest, " mm");
    CHECK(farthest < 1e-9 * 24);
    for (const auto& [label, volume] : volumes_mm3(axis))
      CHECK(volumes_mm3(skeleton).at(label) == doctest::Approx(volume).epsilon(1e-9));
  }
}

TEST_CASE("straight-skeleton: every point has the label of the front that arrives first") {
  std::mt19937 rng(11);
  for (int round = 0; round < 4; ++round) {
    std::vector<TrackedSlice> slices;
    for (int i = 0; i < 4; ++i)
      slices.push_back(patch(random_frame(rng, 12), i == 3 ? circle({2, 0}, 9, 7) : rectangle({-12, -7}, {9, 11}),
                             {{circle({1, 2}, 8, 31), 1}, {circle({-4, 3}, 6, 17), 2}}));
    CHECK(errors_among(slices, surfaces(slices), {-14, -14, -14}, {14, 14, 14}) == 0);
  }
}

TEST_CASE("straight-skeleton: three floating patches make one knuckle") {
  std::vector<TrackedSlice> slices;
  for (int i = 0; i < 3; ++i) {
    const double angle = 2 * std::numbers::pi / 3 * i;
    const Vector3d outwards(std::cos(angle), std::sin(angle), 0);
    slices.push_back(patch(frame_at(20 * outwards, outwards), square(15), {{circle({0, 0}, 8, 40), 1}}));
  }
  const ContourSurfaces knuckle = surfaces(slices);
  CHECK(parts(knuckle, 1) == 1);
  CHECK(label_of(knuckle, {0.1, 0.2, 0.3}) == 1);
  CHECK(label_of(knuckle, {0.1, 0.2, 9}) == 0);
  CHECK(knuckle.notes.empty());
  CHECK(errors_among(slices, knuckle, {-22, -22, -14}, {22, 22, 14}) == 0);
  for (const TrackedSlice& slice : slices)
    CHECK(label_of(knuckle, slice.image_to_reference * Vector3d(1, 1, 0.1)) == 1);
}

TEST_CASE("straight-skeleton: green connects to green between two patches with red, and not through a full plane") {
  const auto sections = [](bool partial) {
    std::vector<TrackedSlice> slices;
    for (const double z : {0.0, 12.0}) slices.push_back(patch(level(z), square(30), {{circle({0, 0}, 6, 40), 1}}));
    for (const double x : {-21.0, 21.0}) {
      const Loop2d view = rectangle({x - 9, -30}, {x + 9, 30});
      slices.push_back(patch(level(6), partial ? view : Loop2d{}, {{circle({x, 0}, 5, 30), 2}}));
    }
    if (!partial) {  // both in one slice
      add_loop(slices[2], circle({21, 0}, 5, 30), 2);
      slices.pop_back();
    }
    return slices;
  };
  const ContourSurfaces between = surfaces(sections(true)), cut = surfaces(sections(false));
  CHECK(parts(between, 1) == 1);
  CHECK(parts(between, 2) == 2);
  CHECK(label_of(between, {1, 1, 6.5}) == 1);
  CHECK(label_of(between, {21, 1, 6.5}) == 2);
  CHECK(parts(cut, 1) == 2);
  CHECK(label_of(cut, {1, 1, 6.5}) == 0);
  CHECK(errors_among(sections(true), between, {-28, -14, -4}, {28, 14, 16}) == 0);
}

TEST_CASE("straight-skeleton: a guiding patch joins two stripes") {
  std::vector<TrackedSlice> slices{patch(level(0), {}, {{rectangle({-30, -12}, {30, -4}), 1}}),
                                   patch(level(10), {}, {{rectangle({-30, 4}, {30, 12}), 1}})};
  CHECK(parts(surfaces(slices), 1) == 2);
  Eigen::Isometry3d across = Eigen::Isometry3d::Identity();  // x along y, y along z
  across.linear().col(0) = Vector3d::UnitY();
  across.linear().col(1) = Vector3d::UnitZ();
  across.linear().col(2) = Vector3d::UnitX();
  slices.push_back(patch(across, rectangle({-6, 1}, {6, 9}), {{rectangle({-7, 0}, {7, 10}), 1}}));
  const ContourSurfaces guided = surfaces(slices);
  CHECK(parts(guided, 1) == 1);
  CHECK(label_of(guided, {0.1, 0.2, 5}) == 1);
  CHECK(label_of(guided, {20, 0.2, 5.1}) == 0);
}

TEST_CASE("straight-skeleton: four spheres that intersect are 13 domains, from partial slices") {
  constexpr int kPixels = 121;
  constexpr double kPixel_mm = 0.25, kHalf_mm = 15;
  const auto domain = [](const Vector3d& p) {
    unsigned domains = 0;
    for (unsigned ball = 0; ball < 4; ++ball)
      if ((p - Vector3d((ball & 1) != 0 ? 5 : -5, (ball & 2) != 0 ? 5 : -5, 0)).norm() < 8) domains |= 1u << ball;
    return static_cast<Label>(domains);
  };
  const auto sampled = [&](const Eigen::Isometry3d& frame, const Loop2d& view) {
    std::vector<Label> labels;
    for (int y = 0; y < kPixels; ++y)
      for (int x = 0; x < kPixels; ++x)
        labels.push_back(domain(frame * Vector3d(x * kPixel_mm - kHalf_mm, y * kPixel_mm - kHalf_mm, 0)));
    const MaskContours traced = trace_mask({kPixels, kPixels, labels});
    TrackedSlice slice;
    slice.image_to_reference = frame;
    for (const Vector2d& p : traced.points) slice.points.emplace_back(kPixel_mm * p - Vector2d(kHalf_mm, kHalf_mm));
    slice.contours = traced.contours;
    slice.field_of_view = view;
    return slice;
  };
  const std::vector<TrackedSlice> slices{
      sampled(level(0.5), square(14)), sampled(level(-5), rectangle({-14, -14}, {2, 14})),
      sampled(level(5.5), rectangle({-1, -14}, {14, 14})),
      sampled(frame_at({6, 0.5, 0}, Vector3d::UnitX()), rectangle({-9, -12}, {9, 12}))};
  const ContourSurfaces spheres = surfaces(slices);
  std::set<Label> domains;
  for (const auto& [label, volume] : volumes_mm3(spheres))
    if (label != kOutside && volume > 1) domains.insert(label);
  CHECK(domains.size() == 13);
  CHECK(!domains.contains(0b0110));  // two that are diagonal have nothing of their own
  CHECK(!domains.contains(0b1001));
  CHECK(errors_among(slices, spheres, {-13, -13, -8}, {13, 13, 8}) == 0);
}

TEST_CASE("straight-skeleton: patches with bends, holes and shadows keep their contours") {
  const Loop2d bent{{-20, -20}, {20, -20}, {20, 0}, {3, 0}, {3, 20}, {-20, 20}};
  Loop2d sector;
  for (int i = 0; i <= 8; ++i) sector.push_back(20 * Vector2d(std::cos(0.6 + 0.25 * i), std::sin(0.6 + 0.25 * i)));
  for (int i = 8; i >= 0; --i) sector.push_back(6 * Vector2d(std::cos(0.6 + 0.25 * i), std::sin(0.6 + 0.25 * i)));
  const std::vector<std::pair<Loop2d, Label>> contours{{circle({0, 3}, 11, 31), 1}, {circle({-2, 9}, 6, 23), 2}};
  auto shadowed = contours;
  shadowed.emplace_back(Loop2d{{4, 2}, {9, -3}, {12, 1}, {8, 7}}, kUnknown);
  std::mt19937 rng(2);
  surfaces({patch(random_frame(rng, 8), bent, contours), patch(random_frame(rng, 8), sector, contours),
            patch(random_frame(rng, 8), {}, shadowed), patch(random_frame(rng, 8), square(16), shadowed)});
}

TEST_CASE("straight-skeleton: patches of one plane, in a stack, and those whose rims lie on others, close") {
  const std::vector<std::pair<Loop2d, Label>> disc{{circle({0, 0}, 10, 40), 1}};
  const Loop2d left = rectangle({-20, -15}, {-3, 15}), right = rectangle({2, -15}, {20, 12});
  surfaces({patch(level(0), left, disc), patch(level(0), right, disc), patch(level(9), left, disc),
            patch(level(9), rectangle({0, -15}, {15, 15}), {{circle({3, 0}, 7, 30), 2}})});
  Eigen::Isometry3d turned = level(0);
  turned.linear() = Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitY()).toRotationMatrix();
  surfaces({patch(level(0), left, disc), patch(turned, left, disc), patch(level(12), {}, disc)});
  Eigen::Isometry3d upright = Eigen::Isometry3d::Identity();
  upright.linear() = Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitX()).toRotationMatrix();
  const ContourSurfaces joined =
      surfaces({patch(level(0), square(15), disc), patch(upright, rectangle({-15, 0}, {15, 15}), disc)});
  CHECK(parts(joined, 1) == 1);
}

TEST_CASE("straight-skeleton: a sharp corner that runs ahead of the front around another patch is noted") {
  const Loop2d spike{{-40, -4}, {0, 0}, {-40, 4}};
  const std::vector<TrackedSlice> slices{
      patch(level(0), spike, {{rectangle({-50, -10}, {10, 10}), 1}}),
      patch(frame_at({2, 0, 0}, Vector3d::UnitX()), square(3), {{circle({0, 0}, 1, 9), 2}})};
  const ContourSurfaces ahead = surfaces(slices);
  REQUIRE(ahead.notes.size() == 1);
  CHECK(ahead.notes[0].find("could only come through another one") != std::string::npos);
}

TEST_CASE("straight-skeleton: the number of threads changes nothing") {
  std::mt19937 rng(3);
  std::vector<TrackedSlice> slices;
  for (int i = 0; i < 4; ++i) slices.push_back(patch(random_frame(rng, 6), square(12), {{circle({3, 1}, 10, 31), 1}}));
  const auto one = straight_skeleton(slices, {true, 1}), four = straight_skeleton(slices, {true, 4});
  REQUIRE(one);
  REQUIRE(four);
  CHECK(one->positions == four->positions);
  CHECK(one->triangles == four->triangles);
  CHECK(one->label_front == four->label_front);
}

TEST_CASE("straight-skeleton: slices without contours and rims with too many bends are errors that say so") {
  const auto bends = straight_skeleton(
      std::vector{patch(level(0), {}, {{circle({0, 0}, 10), 1}, {circle({2, 0}, 4, 200), kUnknown}})}, {});
  REQUIRE(!bends);
  CHECK(bends.error().code == ErrorCode::too_large);
  CHECK(bends.error().message.find("few bends inwards") != std::string::npos);
  const auto empty = straight_skeleton(std::vector{slice_at(0, {}), patch(level(4), square(3), {})}, {});
  REQUIRE(!empty);
  CHECK(empty.error().code == ErrorCode::empty_input);
}
