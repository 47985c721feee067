#include "core/methods/equal_importance/equal_importance.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "tests/support/mesh/contour_distance.h"
#include "tests/support/mesh/mesh_check.h"
#include "tests/support/planes.h"
#include "tests/support/stacks/stack_slices.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

constexpr double kCell = 0.5;
constexpr double kPi = std::numbers::pi;

IndexedMesh surfaces(const std::vector<TrackedSlice>& slices, ContourForm form = ContourForm::dense) {
  auto made = equal_importance(slices, {kCell, form, 2});
  if (!made) FAIL(made.error().message);
  const MeshReport report = check_mesh(made->mesh);
  CHECK_MESSAGE(report.closed_manifold(), report.text());
  return std::move(made->mesh);
}

struct Off {
  double mean = 0, most = 0;
};

/// How far vertices are off, in cells; where the measure is not a number they do not count.
Off off_by(const IndexedMesh& mesh, const std::function<double(const Eigen::Vector3d&)>& distance_mm) {
  Off off;
  double count = 0;
  for (const Eigen::Vector3f& p : mesh.positions) {
    const double cells = std::abs(distance_mm(p.cast<double>())) / kCell;
    if (std::isnan(cells)) continue;
    off.mean += cells;
    off.most = std::max(off.most, cells);
    ++count;
  }
  off.mean /= count;
  return off;
}

TrackedSlice slice_in(const Eigen::Vector3d& origin, const Eigen::Vector3d& x, const Eigen::Vector3d& y,
                      const std::vector<Loop2d>& loops) {
  TrackedSlice slice = slice_at(0, loops);
  slice.image_to_reference.linear().col(0) = x;
  slice.image_to_reference.linear().col(1) = y;
  slice.image_to_reference.linear().col(2) = x.cross(y);
  slice.image_to_reference.translation() = origin;
  return slice;
}

/// Slices across a tube that bends about the z axis, and not one turned in its plane as the one before.
std::vector<TrackedSlice> bent_tube(double bend_mm, double radius_mm, int count, double angle) {
  std::vector<TrackedSlice> slices;
  for (int i = 0; i < count; ++i) {
    const double at = angle * i / (count - 1);
    const Eigen::Vector3d out(std::cos(at), std::sin(at), 0), up = Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d x = std::cos(i) * out + std::sin(i) * up, y = -std::sin(i) * out + std::cos(i) * up;
    slices.push_back(slice_in(bend_mm * out - 3 * x, x, y, {circle({3, 0}, radius_mm)}));
  }
  return slices;
}

/// Slices through the z axis of a body that is so wide at a height, for heights -15 to 15.
std::vector<TrackedSlice> turned_body(const std::function<double(double)>& radius_at, int count) {
  std::vector<TrackedSlice> slices;
  for (int i = 0; i < count; ++i) {
    const double at = kPi * i / count + 0.1;
    Loop2d loop;
    for (int side = -1; side <= 1; side += 2)
      for (int k = -60; k <= 60; ++k) loop.emplace_back(-side * radius_at(-side * k / 4.0), -side * k / 4.0);
    slices.push_back(
        slice_in(Eigen::Vector3d::Zero(), {std::cos(at), std::sin(at), 0}, Eigen::Vector3d::UnitZ(), {loop}));
  }
  return slices;
}

}  // namespace

TEST_CASE("equal importance: between circles runs the cone, in both forms") {
  const std::vector<TrackedSlice> slices{slice_at(0, {circle({0, 0}, 30, 360)}), slice_at(8, {circle({0, 0}, 20, 360)}),
                                         slice_at(16, {circle({0, 0}, 10, 360)})};
  for (const ContourForm form : {ContourForm::dense, ContourForm::sparse}) {
    const Off off = off_by(surfaces(slices, form), [](const Eigen::Vector3d& p) {
      return p.z() > kCell && p.z() < 16 - kCell ? p.head<2>().norm() - (30 - 20 * p.z() / 16) : NAN;
    });
    MESSAGE("off the cone by ", off.mean, " cells, at most ", off.most);
    CHECK(off.most < 0.3);
  }
}

TEST_CASE("equal importance: of few nested contours equal shares make the better cone over a star") {
  const auto star = [](double angle) { return 1 + 0.35 * std::cos(5 * angle); };
  std::vector<TrackedSlice> slices;
  for (const double size : {30.0, 20.0, 40.0 / 3}) {
    Loop2d loop;
    for (int i = 0; i < 720; ++i) {
      const double angle = kPi * i / 360;
      loop.push_back(size * star(angle) * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
    slices.push_back(slice_at(36 - 1.2 * size, {loop}));
  }
  const auto off_cone = [&](const Eigen::Vector3d& p) {
    return p.z() > 0.7 && p.z() < 19.3 ? p.head<2>().norm() - (30 - p.z() / 1.2) * star(std::atan2(p.y(), p.x())) : NAN;
  };
  const Off dense = off_by(surfaces(slices), off_cone),
            sparse = off_by(surfaces(slices, ContourForm::sparse), off_cone);
  MESSAGE("off the cone: dense ", dense.mean, " cells, sparse ", sparse.mean);
  CHECK(sparse.mean < 0.8 * dense.mean);
  CHECK(sparse.most < dense.most);
}

TEST_CASE("equal importance: slices along a curve make the bent tube") {
  const IndexedMesh mesh = surfaces(bent_tube(40, 8, 9, 2.2));
  const Off off = off_by(mesh, [](const Eigen::Vector3d& p) {
    const double at = std::atan2(p.y(), p.x());
    return at > 0.03 && at < 2.17 ? std::hypot(p.head<2>().norm() - 40, p.z()) - 8 : NAN;
  });
  MESSAGE("off the tube by ", off.mean, " cells, at most ", off.most);
  CHECK(off.most < 0.25);
  CHECK(check_mesh(mesh).labels.at(1).components == 1);
  const double volume = kPi * 64 * 40 * 2.2;  // Pappus
  CHECK(check_mesh(mesh).labels.at(1).volume_mm3 == doctest::Approx(volume).epsilon(0.005));
}

TEST_CASE("equal importance: slices about an axis make the turned body, wherever it lies") {
  const auto radius_at = [](double z) { return 10 + 3 * std::sin(z / 4); };
  std::vector<TrackedSlice> slices = turned_body(radius_at, 6);
  std::mt19937 random(3);
  const Eigen::Isometry3d moved = random_frame(random, 200);
  for (TrackedSlice& s : slices) s.image_to_reference = moved * s.image_to_reference;
  const IndexedMesh mesh = surfaces(slices);
  const Off off = off_by(mesh, [&](const Eigen::Vector3d& at) {
    const Eigen::Vector3d p = moved.inverse() * at;
    return std::abs(p.z()) < 14 ? p.head<2>().norm() - radius_at(p.z()) : NAN;
  });
  MESSAGE("off the body by ", off.mean, " cells, at most ", off.most);
  CHECK(off.most < 0.25);
  CHECK(check_mesh(mesh).labels.at(1).genus() == 0);
  std::vector<double> distances = contour_distances(slices, mesh);
  std::ranges::sort(distances);
  CHECK(distances[distances.size() * 95 / 100] < 0.1 * kCell);
}

TEST_CASE("equal importance: labels that lie in and beside each other come out closed about an axis") {
  std::vector<TrackedSlice> slices = turned_body([](double) { return 12.0; }, 5);
  for (TrackedSlice& s : slices) {
    add_loop(s, rectangle({-5, -6}, {5, 4}), 2);
    add_loop(s, rectangle({-5, 4}, {5, 9}), 3);
  }
  const MeshReport report = check_mesh(surfaces(slices));
  REQUIRE(report.labels.size() == 4);
  CHECK(report.labels.at(2).volume_mm3 == doctest::Approx(kPi * 25 * 10).epsilon(0.02));
  CHECK(report.labels.at(3).volume_mm3 == doctest::Approx(kPi * 25 * 5).epsilon(0.03));
}

TEST_CASE("equal importance: slices that lie in no order are an error that says which do") {
  const Loop2d loop = circle({0, 0}, 10);
  const std::vector<TrackedSlice> crossed{
      slice_in(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), {loop}),
      slice_in(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ(), {loop}),
      slice_in(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX(), {loop})};
  std::vector<TrackedSlice> twice = turned_body([](double) { return 10.0; }, 3), hollow = bent_tube(40, 8, 5, 1.5);
  twice.push_back(twice[1]);
  hollow[2] = slice_in(hollow[2].image_to_reference.translation(), hollow[2].image_to_reference.linear().col(0),
                       hollow[2].image_to_reference.linear().col(1), {});
  for (const auto& [slices, words] :
       {std::pair{crossed, "slice 1 reaches through the plane of a neighbour"},
        std::pair{twice, "slice 4 has the angle of another"}, std::pair{hollow, "slice 3 is empty"}}) {
    const auto refused = equal_importance(slices, {kCell});
    REQUIRE(!refused);
    MESSAGE(refused.error().message);
    CHECK(refused.error().code == ErrorCode::invalid_argument);
    CHECK(refused.error().message.find(words) != std::string::npos);
  }
}
