// What C reads.
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "tests/unit/capi/capi_scan.h"

using namespace sonoloft::test;

extern "C" std::size_t sizes_in_c(std::size_t index);

namespace {

constexpr std::uint32_t kSlices = 8;

/// The volume of a label by the divergence theorem, ml.
double volume_ml(const sonoloft_mesh_arrays& mesh, std::uint16_t label) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles; ++t) {
    std::array<const float*, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = mesh.positions_mm + 3 * mesh.corners[3 * t + i];
    const auto at = [&](std::size_t i, int axis) { return static_cast<double>(p[i][axis]); };
    const double six = at(0, 0) * (at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)) -
                       at(0, 1) * (at(1, 0) * at(2, 2) - at(1, 2) * at(2, 0)) +
                       at(0, 2) * (at(1, 0) * at(2, 1) - at(1, 1) * at(2, 0));
    if (mesh.label_pairs[2 * t + 1] == label) sum += six / 6;
    if (mesh.label_pairs[2 * t] == label) sum -= six / 6;
  }
  return 1e-3 * sum;
}

/// Of every label, edges that its triangles do not run once in each direction.
std::size_t open_edges(const sonoloft_mesh_arrays& mesh, std::uint16_t label) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (std::size_t t = 0; t < mesh.triangles; ++t) {
    const std::uint16_t* pair = mesh.label_pairs + 2 * t;
    if (pair[0] != label && pair[1] != label) continue;
    const int sign = pair[1] == label ? 1 : -1;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = mesh.corners[3 * t + i], b = mesh.corners[3 * t + (i + 1) % 3];
      balance[std::minmax(a, b)] += a < b ? sign : -sign;
    }
  }
  std::size_t open = 0;
  for (const auto& [edge, sum] : balance) open += sum != 0;
  return open;
}

}  // namespace

TEST_CASE("capi: a mesh is closed for every label and has the volumes that it states") {
  sonoloft_scan* const scan = open_scan(kSlices);
  Follower follower;
  follower.start(scan);
  REQUIRE(follower.wait_for(SONOLOFT_END_OF_DATA));
  sonoloft_scan_close(scan);

  const sonoloft_mesh_info* info = sonoloft_mesh_get_info(follower.last());
  CHECK(info->revision == kSlices);
  CHECK(info->detail == SONOLOFT_FULL);
  const sonoloft_mesh_arrays* mesh = sonoloft_mesh_get_arrays(follower.last());
  REQUIRE(mesh);
  CHECK(mesh == sonoloft_mesh_get_arrays(follower.last()));
  CHECK(mesh->triangles > 500);
  for (std::size_t i = 0; i < 3 * mesh->triangles; ++i) REQUIRE(mesh->corners[i] < mesh->vertices);
  REQUIRE(info->labels >= 2);
  for (std::size_t i = 0; i < info->labels; ++i) {
    const sonoloft_label* label = sonoloft_mesh_label(follower.last(), i);
    CHECK(open_edges(*mesh, label->label) == 0);
    CHECK(volume_ml(*mesh, label->label) == doctest::Approx(label->volume_ml).epsilon(1e-4));
  }
  CHECK(sonoloft_mesh_label(follower.last(), info->labels) == nullptr);
}

TEST_CASE("capi: slices come with contours, a rigid pose, times and their fate") {
  sonoloft_scan* const scan = open_scan(kSlices);
  std::size_t slices = 0, contours = 0;
  Follower follower([&](sonoloft_mesh* mesh) {
    const std::size_t count = sonoloft_mesh_get_info(mesh)->slices;
    for (std::size_t i = 0; i < count; ++i) {
      const sonoloft_slice& slice = *sonoloft_mesh_slice(mesh, i);
      CHECK(slice.id == slices++);
      CHECK(slice.pose_ok == 1);
      CHECK(slice.time_ns > 0);
      CHECK(slice.latency_ms > 0);
      CHECK(slice.fate != SONOLOFT_REFUSED);
      const double* r = slice.image_to_reference;
      for (int a = 0; a < 3; ++a) CHECK(r[a] * r[a] + r[a + 4] * r[a + 4] + r[a + 8] * r[a + 8] == doctest::Approx(1));
      contours += slice.contours;
      for (std::size_t c = 0; c < slice.contours; ++c) {
        CHECK(slice.contour[c].first + slice.contour[c].count <= slice.points);
        CHECK(slice.contour[c].label <= 5);
      }
      CHECK(std::isfinite(slice.points_mm[2 * slice.points - 1]));
      CHECK(slice.field_of_view_points >= 3);
    }
    CHECK(sonoloft_mesh_slice(mesh, count) == nullptr);
  });
  follower.start(scan);
  REQUIRE(follower.wait_for(SONOLOFT_END_OF_DATA));
  sonoloft_scan_close(scan);
  CHECK(slices == kSlices);
  CHECK(contours >= kSlices);
}

TEST_CASE("capi: the chunks that changed, mesh after mesh, are the last mesh") {
  sonoloft_scan* const scan = open_scan(kSlices);
  std::map<std::array<std::int32_t, 3>, std::size_t> triangles;
  std::size_t vanished = 0, seen = 0;
  Follower follower([&](sonoloft_mesh* mesh) {
    const std::size_t count = sonoloft_mesh_changed_chunks(mesh);
    for (std::size_t i = 0; i < count; ++i) {
      const sonoloft_chunk& chunk = *sonoloft_mesh_changed_chunk(mesh, i);
      ++seen;
      triangles[{chunk.x, chunk.y, chunk.z}] = chunk.triangles;
      vanished += chunk.triangles == 0 ? 1 : 0;
      for (std::size_t c = 0; c < 3 * chunk.triangles; ++c) CHECK(chunk.corners[c] < chunk.vertices);
      for (std::size_t t = 0; t < chunk.triangles; ++t) {
        CHECK(chunk.label_pairs[2 * t] != chunk.label_pairs[2 * t + 1]);
      }
    }
    CHECK(sonoloft_mesh_changed_chunk(mesh, count) == nullptr);
  });
  follower.start(scan);
  REQUIRE(follower.wait_for(SONOLOFT_END_OF_DATA));
  sonoloft_scan_close(scan);
  std::size_t sum = 0;
  for (const auto& [coord, count] : triangles) sum += count;
  CHECK(sum == sonoloft_mesh_get_arrays(follower.last())->triangles);
  CHECK(follower.slices() == static_cast<int>(kSlices));
  MESSAGE(follower.meshes() << " meshes, " << seen << " chunks told, " << vanished << " vanished");
}

TEST_CASE("capi: coverage, confidence, withdrawal and the device's names") {
  sonoloft_scan* const scan = open_scan(kSlices);
  CHECK(std::string(sonoloft_scan_device(scan)->serial) == "SIM-0001");
  CHECK(std::string(sonoloft_scan_device(scan)->field_device).find("CPU") != std::string::npos);
  Follower follower;
  follower.start(scan);
  REQUIRE(follower.wait_for(SONOLOFT_END_OF_DATA));
  sonoloft_scan_stop(scan);

  sonoloft_coverage coverage{};
  coverage.size = sizeof coverage;
  CHECK(sonoloft_scan_coverage(scan, &coverage, nullptr) == SONOLOFT_OK);
  CHECK(coverage.volume_ml > 500);
  CHECK(coverage.seen_ml > 0);
  CHECK(coverage.seen_ml <= coverage.volume_ml);
  CHECK(coverage.gap_ml > 0);
  CHECK(coverage.near_mm == doctest::Approx(12));

  const sonoloft_mesh_arrays* mesh = sonoloft_mesh_get_arrays(follower.last());
  std::vector<float> measured(mesh->vertices, -1), distance_mm(mesh->vertices, -1);
  CHECK(sonoloft_scan_confidence(scan, mesh->positions_mm, mesh->vertices, measured.data(), distance_mm.data(),
                                 nullptr) == SONOLOFT_OK);
  for (std::size_t v = 0; v < mesh->vertices; ++v) {
    REQUIRE(measured[v] >= 0);
    REQUIRE(measured[v] <= 1);
    REQUIRE(distance_mm[v] >= 0);
  }
  CHECK(sonoloft_scan_withdraw(scan, 0, nullptr) == SONOLOFT_OK);
  CHECK(sonoloft_scan_withdraw(scan, 0, nullptr) == SONOLOFT_INVALID_ARGUMENT);
  sonoloft_scan_close(scan);
}

TEST_CASE("capi: the published field is a choice, and what is no choice of caps is refused") {
  const auto triangles = [](int step_field) {
    sonoloft_scan_options options = scan_options();
    options.step_field = step_field;
    options.caps = SONOLOFT_CAPS_BOX;
    sonoloft_scan* const scan = open_scan(kSlices, 0, options);
    Follower follower;
    follower.start(scan);
    REQUIRE(follower.wait_for(SONOLOFT_END_OF_DATA));
    sonoloft_scan_stop(scan);
    sonoloft_scan_close(scan);
    return sonoloft_mesh_get_arrays(follower.last())->triangles;
  };
  const std::size_t smooth = triangles(0), step = triangles(1);
  CHECK(smooth > 100);
  CHECK(step > 100);
  CHECK(smooth != step);
  for (const int caps : {-1, 3}) {
    sonoloft_scan_options options = scan_options();
    options.caps = caps;
    sonoloft_scan* scan = nullptr;
    sonoloft_error error{};
    CHECK(sonoloft_scan_open(simulated_probe(1, 0), &options, &scan, &error) == SONOLOFT_INVALID_ARGUMENT);
    CHECK(scan == nullptr);
  }
}

TEST_CASE("capi: structs have one size in C and in C++, and contours that of their bytes") {
  const std::array sizes{sizeof(sonoloft_error),        sizeof(sonoloft_simulation), sizeof(sonoloft_mesh_info),
                         sizeof(sonoloft_mesh_arrays),  sizeof(sonoloft_contour),    sizeof(sonoloft_slice),
                         sizeof(sonoloft_scan_options), sizeof(sonoloft_callbacks),  sizeof(sonoloft_statistics),
                         sizeof(sonoloft_coverage),     sizeof(sonoloft_chunk),      sizeof(sonoloft_event),
                         sizeof(sonoloft_transport)};
  for (std::size_t i = 0; i < sizes.size(); ++i) CHECK(sizes_in_c(i) == sizes[i]);
  CHECK(sizeof(sonoloft_contour) == 12);
  CHECK(sizeof(sonoloft_error) == 512);
}
