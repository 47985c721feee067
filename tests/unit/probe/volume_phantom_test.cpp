#include "device_sim/probe/phantoms/volume_phantom.h"

#include <doctest/doctest.h>

#include <functional>
#include <numbers>
#include <set>
#include <string>
#include <utility>

#include "tests/support/phantom_section.h"

namespace test = sonoloft::test;
using namespace sonoloft::device_sim;

namespace {

const Eigen::Vector3i kDims(96, 90, 50);
const Eigen::Vector3d kSpacing(0.6, 0.7, 1.3), kOrigin(-20, 5, 100);
const Eigen::Vector3d kCentre = kOrigin + Eigen::Vector3d(28, 31, 32);

std::vector<Label> voxels(const std::function<Label(const Eigen::Vector3d&)>& label_at) {
  std::vector<Label> labels;
  for (int z = 0; z < kDims.z(); ++z)
    for (int y = 0; y < kDims.y(); ++y)
      for (int x = 0; x < kDims.x(); ++x)
        labels.push_back(label_at(kOrigin + Eigen::Vector3d(x, y, z).cwiseProduct(kSpacing)));
  return labels;
}

Made<VolumePhantom> make(const std::function<Label(const Eigen::Vector3d&)>& label_at) {
  return VolumePhantom::make(kDims, kSpacing, kOrigin, voxels(label_at));
}

Label ball(const Eigen::Vector3d& p) {
  return (p - kCentre).norm() <= 22 ? 4 : 0;
}

/// A ball of two halves, divided by a tilted plane.
Label halves(const Eigen::Vector3d& p) {
  if (ball(p) == 0) return 0;
  return (p - kCentre).dot(Eigen::Vector3d(1, 0.3, 0.2).normalized()) < 2 ? 1 : 2;
}

}  // namespace

TEST_CASE("volume: the stairs of a ball's voxels vanish from its sections") {
  const auto made = make(ball);
  REQUIRE(made.value);
  Random random(3);
  double worst = 0, sum = 0;
  std::size_t count = 0;
  for (int i = 0; i < 20; ++i) {
    Eigen::Isometry3d cut = test::random_plane({kCentre, kCentre}, random);
    cut.translate(Eigen::Vector3d(0, 0, -15 + 1.5 * i));
    const PhantomSection section = made.value->section(cut);
    REQUIRE(section.loops.size() == 1);
    CHECK(test::well_formed(section));
    const double d = -15 + 1.5 * i;
    CHECK(std::abs(test::loop_area(section.points) / (std::numbers::pi * (484 - d * d)) - 1) < 0.02);
    for (const Eigen::Vector2d& p : section.points) {
      const double off = std::abs((cut * Eigen::Vector3d(p.x(), p.y(), 0) - kCentre).norm() - 22);
      worst = std::max(worst, off);
      sum += off;
      ++count;
    }
  }
  MESSAGE("distance from the ball: mean " << sum / static_cast<double>(count) << " mm, largest " << worst
                                          << " mm; a voxel is 0.6 x 0.7 x 1.3 mm");
  CHECK(sum / static_cast<double>(count) < 0.1);
  CHECK(worst < 0.5);
}

TEST_CASE("volume: two labels that touch keep one and the same border") {
  const auto made = make(halves);
  REQUIRE(made.value);
  const PhantomSection section = made.value->section(test::plane_at(kCentre, {0.1, 0.5, 1}));
  REQUIRE(section.loops.size() == 2);
  CHECK(test::well_formed(section));
  std::set<std::pair<double, double>> first;
  for (const Eigen::Vector2d& p : test::points_of(section, section.loops[0])) first.insert({p.x(), p.y()});
  std::vector<Eigen::Vector2d> shared;
  for (const Eigen::Vector2d& p : test::points_of(section, section.loops[1]))
    if (first.contains({p.x(), p.y()})) shared.push_back(p);
  // The chord where the dividing plane crosses the disc; its points are one to three grid lines apart.
  MESSAGE(shared.size() << " shared points on about 44 mm");
  CHECK(shared.size() > 44 / (3 * made.value->grid_mm()));
  CHECK(test::label_area(section, 1) + test::label_area(section, 2) ==
        doctest::Approx(std::numbers::pi * 484).epsilon(0.02));
  // Between the halves is nothing else: along a line across the border every point has one of the two labels.
  for (double x = -15; x <= 15; x += 0.01) CHECK(test::label_in_section(section, {x, 0.1}) != kOutside);
}

TEST_CASE("volume: most voxels keep their label") {
  const auto made = make(halves);
  REQUIRE(made.value);
  const std::vector<Label> labels = voxels(halves);
  double both[3] = {}, phantom[3] = {}, volume[3] = {};
  std::size_t i = 0;
  for (int z = 0; z < kDims.z(); ++z) {
    for (int y = 0; y < kDims.y(); ++y) {
      for (int x = 0; x < kDims.x(); ++x, ++i) {
        const Label got = made.value->label_at(kOrigin + Eigen::Vector3d(x, y, z).cwiseProduct(kSpacing));
        ++phantom[got];
        ++volume[labels[i]];
        both[got] += got == labels[i];
      }
    }
  }
  for (int label : {1, 2}) {
    const double dice = 2 * both[label] / (phantom[label] + volume[label]);
    MESSAGE("label " << label << ": Dice " << dice);
    CHECK(dice > 0.98);
  }
}

TEST_CASE("volume: a body that fills its volume is closed at the volume's rim") {
  const auto made = make([](const Eigen::Vector3d&) -> Label { return 9; });
  REQUIRE(made.value);
  const PhantomSection section = made.value->section(test::plane_at(kCentre, {0, 0, 1}));
  REQUIRE(section.loops.size() == 1);
  const double exact = kDims.x() * kSpacing.x() * kDims.y() * kSpacing.y();
  CHECK(test::loop_area(section.points) == doctest::Approx(exact).epsilon(0.01));
  CHECK(made.value->label_at(kOrigin) == kOutside);  // a blurred corner
  CHECK(made.value->label_at(kCentre) == 9);
  CHECK(made.value->label_at({1e9, -1e9, 0}) == kOutside);
}

TEST_CASE("volume: input that is no volume is refused and says why") {
  const std::vector<Label> good = voxels(ball);
  const auto refused = [&](const Eigen::Vector3i& dims, const Eigen::Vector3d& spacing,
                           const std::vector<Label>& labels, const char* word) {
    const auto made = VolumePhantom::make(dims, spacing, kOrigin, labels);
    INFO(made.error);
    CHECK(!made.value);
    CHECK(made.error.find(word) != std::string::npos);
  };
  refused({0, 90, 50}, kSpacing, good, "no voxels");
  refused({96, -90, -50}, kSpacing, good, "no voxels");
  refused({96, 90, 51}, kSpacing, good, "dimensions");
  refused({2'000'000'000, 2'000'000'000, 2'000'000'000}, kSpacing, good, "2^31");
  refused(kDims, {0.6, 0, 1}, good, "spacing");
  refused(kDims, {0.6, std::nan(""), 1}, good, "spacing");
  refused(kDims, kSpacing, std::vector<Label>(good.size(), 0), "no voxel has a label");
  refused(kDims, kSpacing, std::vector<Label>(good.size(), 0xFFFF), "reserved");
}
