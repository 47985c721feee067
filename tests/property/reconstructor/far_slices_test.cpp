#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "core/reconstructor/reconstructor.h"
#include "tests/support/planes.h"

using namespace sonoloft;

namespace {

constexpr double kRadius_mm = 15.0;
const Eigen::Vector3d kHere(80, 10, -5), kFar(-80, -20, 30);

void add_loop(std::vector<Eigen::Vector2d>& points, const Eigen::Vector2d& centre, double radius_mm, int sides) {
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    points.push_back(centre + radius_mm * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
}

/// A slice of the ball around `ball` at most 10 mm off its centre; it saw 10 mm around the ball and no more.
TrackedSlice slice_of(const Eigen::Vector3d& ball, std::mt19937& rng) {
  std::uniform_real_distribution<double> uniform(-10.0, 10.0);
  const Eigen::Vector3d normal = test::random_direction(rng);
  const double height_mm = uniform(rng);
  TrackedSlice slice;
  slice.image_to_reference = test::frame_at(ball + height_mm * normal, normal);
  add_loop(slice.points, {0, 0}, std::sqrt(kRadius_mm * kRadius_mm - height_mm * height_mm), 60);
  slice.contours.push_back({0, 60, 1, false});
  add_loop(slice.field_of_view, {0, 0}, kRadius_mm + 10.0, 24);
  return slice;
}

struct Counters {
  InsertReport insert;
  UpdateReport update;
  std::size_t cells = 0;

  [[nodiscard]] std::string text() const {
    char line[200];
    std::snprintf(
        line, sizeof line,
        "%6zu cells: visits %u nodes, reaches %u cells, cuts %u and %u faces, clips %u edges; %zu samples, %zu "
        "bricks smoothed, %zu chunks",
        cells, insert.nodes_visited, insert.cells_reached, insert.cells_cut, insert.faces_cut, insert.edges_clipped,
        update.samples_evaluated, update.bricks_smoothed, update.chunks_rebuilt);
    return line;
  }
};

enum class Order {
  apart,       ///< a slice between the two balls, then the far ones, then those here
  here_first,  ///< nothing between them
  far_first,
};

/// What one more slice here costs after 12 slices here and `far_slices` at the other ball.
Counters one_more(int far_slices, Order order) {
  ReconstructorOptions options;
  options.box = {Eigen::Vector3d::Constant(-200), Eigen::Vector3d::Constant(200)};
  options.spacing_mm = 1.5;
  options.admission = Admission::everything;
  options.device = DeviceChoice::cpu;
  auto reconstructor = Reconstructor::create(options);
  REQUIRE(reconstructor);
  std::mt19937 far(1), here(2);
  const auto add = [&](const Eigen::Vector3d& ball, int count, std::mt19937& rng) {
    for (int i = 0; i < count; ++i) REQUIRE(reconstructor->add(slice_of(ball, rng)));
  };
  if (order == Order::apart) {
    TrackedSlice between;
    between.image_to_reference = test::frame_at({0, 0, 0}, {1, 0, 0});
    REQUIRE(reconstructor->add(between));
  }
  if (order == Order::here_first) add(kHere, 12, here);
  add(kFar, far_slices, far);
  if (order != Order::here_first) add(kHere, 12, here);
  REQUIRE(reconstructor->update());
  const auto inserted = reconstructor->add(slice_of(kHere, here));
  REQUIRE(inserted);
  const auto updated = reconstructor->update();
  REQUIRE(updated);
  return {*inserted, *updated, reconstructor->counts().cells};
}

std::string table(const std::vector<Counters>& rows) {
  std::string text;
  for (const Counters& row : rows) text += "\n  " + row.text();
  return text;
}

}  // namespace

TEST_CASE("reconstructor: 80 slices beyond a plane change no counter of a slice inserted on this side of it") {
  const std::vector<Counters> rows = {one_more(0, Order::apart), one_more(20, Order::apart),
                                      one_more(80, Order::apart)};
  for (const Counters& row : rows) {
    CHECK(row.insert.nodes_visited == rows[0].insert.nodes_visited);
    CHECK(row.insert.cells_reached == rows[0].insert.cells_reached);
    CHECK(row.insert.cells_cut == rows[0].insert.cells_cut);
    CHECK(row.insert.faces_cut == rows[0].insert.faces_cut);
    CHECK(row.insert.edges_clipped == rows[0].insert.edges_clipped);
    CHECK(row.update.samples_evaluated == rows[0].update.samples_evaluated);
    CHECK(row.update.bricks_smoothed == rows[0].update.bricks_smoothed);
    CHECK(row.update.chunks_rebuilt == rows[0].update.chunks_rebuilt);
  }
  CHECK(rows[0].update.samples_evaluated > 1000);
  CHECK(rows[2].cells > 50 * rows[0].cells);
  MESSAGE(table(rows));
}

TEST_CASE("reconstructor: with nothing between, 80 later slices far away add a few steps on the way and little else") {
  const std::vector<Counters> rows = {one_more(0, Order::here_first), one_more(20, Order::here_first),
                                      one_more(80, Order::here_first)};
  const auto near = [](auto now, auto then) { return static_cast<double>(now) <= 1.05 * static_cast<double>(then); };
  for (const Counters& row : rows) {
    CHECK(row.insert.nodes_visited <= rows[0].insert.nodes_visited + std::log2(row.cells));
    CHECK(near(row.insert.cells_reached, rows[0].insert.cells_reached));
    CHECK(near(row.insert.faces_cut, rows[0].insert.faces_cut));
    CHECK(near(row.insert.edges_clipped, rows[0].insert.edges_clipped));
    CHECK(near(row.update.samples_evaluated, rows[0].update.samples_evaluated));
    // The far slices cut a few cells here, and slopes follow the walls of the cells.
    CHECK(row.update.bricks_smoothed <= 1.2 * static_cast<double>(rows[0].update.bricks_smoothed));
    CHECK(row.update.chunks_rebuilt <= 1.2 * static_cast<double>(rows[0].update.chunks_rebuilt));
  }
  MESSAGE(table(rows));
}

TEST_CASE(
    "reconstructor: with nothing between, 80 earlier slices far away do not double the cells that a slice reaches") {
  // Cells reach as far as no plane ends them: those of the far slices reach here and are cut here.
  const std::vector<Counters> rows = {one_more(0, Order::far_first), one_more(20, Order::far_first),
                                      one_more(80, Order::far_first)};
  for (const Counters& row : rows) CHECK(row.insert.cells_reached < 2 * rows[0].insert.cells_reached);
  MESSAGE(table(rows));
}
