#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "core/reconstructor/reconstructor.h"
#include "tests/support/mesh/mesh_check.h"
#include "tests/support/mesh/same_bytes.h"
#include "tests/support/planes.h"
#include "tests/support/view_slices.h"

using namespace sonoloft;
using test::same_bytes;

namespace {

/// A hand-held sweep that sees a sector of the body, slices far enough apart to matter.
std::vector<TrackedSlice> sweep(int count, const std::vector<test::Ball>& body = test::body()) {
  std::vector<TrackedSlice> slices;
  const auto frames = test::hand_sweep(1000, 5);
  for (int i = 0; i < count; ++i) {
    slices.push_back(
        test::slice_of_balls(frames[static_cast<std::size_t>(i * 1000 / count)], body, test::sector_view()));
    slices.back().id = static_cast<std::uint64_t>(100 + i);
  }
  return slices;
}

Reconstructor make(Admission admission, int threads, Completion completion = Completion::background) {
  ReconstructorOptions options;
  options.box = {Eigen::Vector3d::Constant(-120), Eigen::Vector3d::Constant(120)};
  options.spacing_mm = 2.5;
  options.background_mm = 4;
  options.admission = admission;
  options.completion = completion;
  options.device = DeviceChoice::cpu;
  options.threads = threads;
  auto reconstructor = Reconstructor::create(options);
  REQUIRE(reconstructor);
  return std::move(*reconstructor);
}

IndexedMesh mesh_of(Reconstructor& reconstructor) {
  REQUIRE(reconstructor.update());
  return reconstructor.mesh().indexed();
}

void add_all(Reconstructor& reconstructor, const std::vector<TrackedSlice>& slices, std::uint64_t but_id = 0) {
  for (const TrackedSlice& slice : slices)
    if (slice.id != but_id) REQUIRE(reconstructor.add(slice));
}

}  // namespace

TEST_CASE("reconstructor: views of a sector, one by one and all at once, with 1 or 2 threads: the same bytes") {
  const std::vector<TrackedSlice> slices = sweep(30);
  for (const Admission admission : {Admission::everything, Admission::news}) {
    Reconstructor batch = make(admission, 1), online = make(admission, 2);
    add_all(batch, slices);
    for (std::size_t i = 0; i < slices.size(); ++i) {
      REQUIRE(online.add(slices[i]));
      REQUIRE(
          online.update(i % 3 == 0 ? Detail::coarse : Detail::full, i % 4 == 3 ? Slopes::settled : Slopes::streaming));
    }
    const IndexedMesh mesh = mesh_of(batch);
    CHECK(mesh.triangles.size() > 5000);
    CHECK(same_bytes(mesh, mesh_of(online)));
    CHECK(batch.counts().samples == online.counts().samples);
  }
}

TEST_CASE("reconstructor: views of a sector give closed surfaces that do not cross themselves") {
  for (const Admission admission : {Admission::everything, Admission::news}) {
    Reconstructor reconstructor = make(admission, 2);
    add_all(reconstructor, sweep(60));
    const IndexedMesh mesh = mesh_of(reconstructor);
    const test::MeshReport report = test::check_mesh(mesh);
    MESSAGE(reconstructor.counts().cells << " cells\n" << report.text());
    CHECK(report.closed_manifold());
    CHECK(report.labels.size() == 3);
    CHECK(test::count_self_intersections(mesh) == 0);
  }
}

TEST_CASE("reconstructor: a slice withdrawn leaves the mesh of the same slices without it") {
  const std::vector<TrackedSlice> slices = sweep(24);
  for (const std::uint64_t gone : {100u, 109u, 123u}) {
    Reconstructor with = make(Admission::everything, 1), without = make(Admission::everything, 1);
    add_all(with, slices);
    REQUIRE(with.update());
    REQUIRE(with.withdraw(gone));
    add_all(without, slices, gone);
    const IndexedMesh mesh = mesh_of(with);
    CHECK(same_bytes(mesh, mesh_of(without)));
    CHECK(with.counts().samples == without.counts().samples);
    const auto again = with.withdraw(gone);
    REQUIRE(!again);
    CHECK(again.error().code == ErrorCode::invalid_argument);
    REQUIRE(with.withdraw(105));  // and added once more: replaced
    REQUIRE(with.add(slices[5]));
    CHECK(test::check_mesh(mesh_of(with)).closed_manifold());
  }
}

TEST_CASE("reconstructor: of a sweep, where nothing is new nothing is cut, and the mesh is that of all cuts") {
  const std::vector<TrackedSlice> slices = sweep(200);
  Reconstructor news = make(Admission::news, 2), everything = make(Admission::everything, 2);
  std::size_t explained = 0, inserted = 0;
  for (const TrackedSlice& slice : slices) {
    const auto report = news.add(slice);
    REQUIRE(report);
    explained += report->outcome == SliceOutcome::explained;
    inserted += report->outcome == SliceOutcome::inserted;
    REQUIRE(everything.add(slice));
  }
  const test::MeshReport few = test::check_mesh(mesh_of(news)), all = test::check_mesh(mesh_of(everything));
  MESSAGE(news.counts().cells << " cells instead of " << everything.counts().cells << "; " << inserted
                              << " slices cut, " << explained << " explained\n"
                              << few.text() << all.text());
  CHECK(news.counts().cells < everything.counts().cells / 4);
  CHECK(explained > 20);
  for (const Label label : {Label{1}, Label{2}})
    CHECK(few.labels.at(label).volume_mm3 == doctest::Approx(all.labels.at(label).volume_mm3).epsilon(0.05));
}

TEST_CASE("reconstructor: where nothing but outside was seen there is no surface") {
  Reconstructor reconstructor = make(Admission::news, 1);
  add_all(reconstructor, sweep(20, {}));
  CHECK(mesh_of(reconstructor).triangles.empty());
}

TEST_CASE("reconstructor: a space of one label stays that label through all shadows, one by one and all at once") {
  std::mt19937 rng(11);
  std::uniform_real_distribution<double> uniform(-40, 40);
  std::vector<TrackedSlice> slices;
  for (std::uint64_t id = 1; id <= 24; ++id) {
    slices.push_back(test::slice_of_balls(test::random_frame(rng, 20), {{{0, 0, 0}, 60, 1}}));
    slices.back().id = id;
    for (int shadow = 0; shadow < 4; ++shadow)
      test::add_contour(slices.back(), test::ring({uniform(rng), uniform(rng)}, 11, 14), kUnknown);
  }
  for (const Admission admission : {Admission::everything, Admission::news}) {
    Reconstructor batch = make(admission, 2), online = make(admission, 1);
    add_all(batch, slices);
    for (const TrackedSlice& slice : slices) {
      REQUIRE(online.add(slice));
      REQUIRE(online.update());
    }
    const IndexedMesh mesh = mesh_of(batch);
    test::MeshReport report = test::check_mesh(mesh);
    MESSAGE(report.text());
    CHECK(report.closed_manifold());
    CHECK(report.labels[1].components == 1);
    CHECK(report.labels[1].genus() == 0);
    CHECK(same_bytes(mesh, mesh_of(online)));
  }
}

TEST_CASE("reconstructor: completed the published way: closed, the same bytes one by one and all at once") {
  const std::vector<TrackedSlice> slices = sweep(12);
  Reconstructor batch = make(Admission::everything, 1, Completion::published);
  Reconstructor online = make(Admission::everything, 2, Completion::published);
  add_all(batch, slices);
  for (std::size_t i = 0; i < slices.size(); ++i) {
    REQUIRE(online.add(slices[i]));
    REQUIRE(online.update(i % 3 == 0 ? Detail::coarse : Detail::full));
  }
  const IndexedMesh mesh = mesh_of(batch);
  const test::MeshReport report = test::check_mesh(mesh);
  MESSAGE(report.text());
  CHECK(report.closed_manifold());
  CHECK(report.labels.size() == 3);
  CHECK(same_bytes(mesh, mesh_of(online)));

  Reconstructor background = make(Admission::everything, 1);
  add_all(background, slices);
  CHECK(!same_bytes(mesh, mesh_of(background)));
}

TEST_CASE("reconstructor: completed the published way, a slice withdrawn leaves the mesh of the others") {
  const std::vector<TrackedSlice> slices = sweep(12);
  Reconstructor with = make(Admission::everything, 1, Completion::published);
  Reconstructor without = make(Admission::everything, 1, Completion::published);
  add_all(with, slices);
  REQUIRE(with.update());
  REQUIRE(with.withdraw(105));
  add_all(without, slices, 105);
  const IndexedMesh a = mesh_of(with), b = mesh_of(without);
  CHECK(a.triangles.size() == b.triangles.size());
  REQUIRE(a.positions.size() == b.positions.size());
  float farthest = 0;  // the cells have other numbers now, and sums another order
  for (std::size_t i = 0; i < a.positions.size(); ++i)
    farthest = std::max(farthest, (a.positions[i] - b.positions[i]).norm());
  MESSAGE("vertices apart by up to " << farthest << " mm");
  CHECK(farthest < 1e-3f * 2.5f);
}

TEST_CASE("reconstructor: what the published completion cannot be given is refused") {
  ReconstructorOptions options;
  options.box = {Eigen::Vector3d::Constant(-120), Eigen::Vector3d::Constant(120)};
  options.spacing_mm = 2.5;
  options.completion = Completion::published;
  options.admission = Admission::news;
  CHECK(!Reconstructor::create(options));
  options.admission = Admission::everything;
  options.hops = 0;
  CHECK(!Reconstructor::create(options));
  options.hops = 1;
  CHECK(Reconstructor::create(options));
}

TEST_CASE("reconstructor: slices that contradict each other give sound surfaces near the truth") {
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const Admission admission : {Admission::everything, Admission::news}) {
    Reconstructor reconstructor = make(admission, 2);
    const auto frames = test::hand_sweep(1000, 8);
    for (std::size_t i = 0; i < 120; ++i) {
      Eigen::Isometry3d pose_off = Eigen::Isometry3d::Identity();  // up to 2 mm
      pose_off.translation() = 1.15 * Eigen::Vector3d(uniform(rng), uniform(rng), uniform(rng));
      TrackedSlice slice = test::slice_of_balls(frames[i * 1000 / 120], test::body(), test::sector_view());
      slice.image_to_reference = slice.image_to_reference * pose_off;
      // Two discs with a wrong label: 1 to 5 % of the sector.
      for (const Label wrong : {Label{2}, kOutside}) {
        const double radius = 3 + 2 * uniform(rng);
        const Eigen::Vector2d at(10 * uniform(rng), 35 + 15 * uniform(rng));
        test::add_contour(slice, test::ring(at, radius, 24), wrong);
        slice.contours.back().hole = wrong == kOutside;
      }
      REQUIRE(reconstructor.add(slice));
      if (i % 10 == 9) REQUIRE(reconstructor.update());
    }
    const IndexedMesh mesh = mesh_of(reconstructor);
    const test::MeshReport report = test::check_mesh(mesh);
    MESSAGE(reconstructor.counts().cells << " cells\n" << report.text());
    CHECK(report.closed_manifold());
    CHECK(test::count_self_intersections(mesh) == 0);
    const double ball_mm3 = 4.0 / 3 * 3.14159265 * 50 * 50 * 50;
    CHECK(-report.labels.at(0).volume_mm3 == doctest::Approx(ball_mm3).epsilon(0.1));
  }
}
