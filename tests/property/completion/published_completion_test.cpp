#include "core/completion/published_completion.h"

#include <doctest/doctest.h>

#include <map>

#include "core/field/reference.h"
#include "tests/support/field/field_cells.h"
#include "tests/support/view_slices.h"

using namespace sonoloft;

namespace {

constexpr double kBox = 120, kSpacing = 6;

/// Cells of views of a sector; everything `scale` times as large.
CellComplex cells_of(int count, const std::vector<test::Ball>& body, double scale = 1) {
  CellComplex cells({Eigen::Vector3d::Constant(-kBox * scale), Eigen::Vector3d::Constant(kBox * scale)}, 0.5 * scale);
  const auto frames = test::hand_sweep(1000, 5);
  for (int i = 0; i < count; ++i) {
    TrackedSlice slice =
        test::slice_of_balls(frames[static_cast<std::size_t>(i * 1000 / count)], body, test::sector_view());
    slice.image_to_reference.translation() *= scale;
    for (Eigen::Vector2d& p : slice.points) p *= scale;
    for (Eigen::Vector2d& p : slice.field_of_view) p *= scale;
    REQUIRE(cells.insert(test::checked_section(slice)));
  }
  return cells;
}

std::vector<Eigen::Vector3d> random_points(test::Random& random, int count) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) points.push_back(test::uniform(random, 0, 70) * test::uniform_direction(random));
  return points;
}

std::map<Label, double> filled(const PublishedCompletion& completion, CellId cell, const Eigen::Vector3d& point) {
  PointShares out;
  completion.shares(cell, std::array{point}, out);
  std::map<Label, double> shares;
  for (std::size_t l = 0; l < out.labels.size(); ++l) shares[out.labels[l]] = static_cast<double>(out.share[l]);
  return shares;
}

double largest_difference(const std::map<Label, double>& a, const std::map<Label, double>& b) {
  REQUIRE(a.size() == b.size());
  double largest = 0;
  for (const auto& [label, share] : a) largest = std::max(largest, std::abs(share - b.at(label)));
  return largest;
}

/// The whole field at a point of a cell.
std::map<Label, double> field(const CellComplex& cells, const PublishedCompletion& completion, CellId cell,
                              const Eigen::Vector3d& point) {
  std::vector<CellFace> faces;
  cells.faces(cell, faces);
  const ReferenceShares known = reference_shares(faces, point, 1e-9);
  std::map<Label, double> shares = filled(completion, cell, point);
  for (auto& [label, share] : shares) share = share * known.share(kUnknown) + known.share(label);
  return shares;
}

}  // namespace

TEST_CASE("completion: shares lie between 0 and 1 and sum to 1, with any hops") {
  const CellComplex cells = cells_of(20, test::body());
  test::Random random(1);
  const auto points = random_points(random, 300);
  for (const std::optional<int> hops : {std::optional(1), std::optional(2), std::optional<int>()}) {
    const PublishedCompletion completion(cells, hops, kSpacing, 2);
    CHECK(completion.cells().size() > 20);
    CHECK(completion.corner_count() > 1000);
    for (const Eigen::Vector3d& p : points) {
      double sum = 0;
      for (const auto& [label, share] : filled(completion, cells.locate(p), p)) {
        CHECK((share >= 0 && share <= 1));
        sum += share;
      }
      CHECK(sum == doctest::Approx(1).epsilon(1e-6));
    }
  }
}

TEST_CASE("completion: where nothing but outside was seen all is outside, exactly") {
  const CellComplex cells = cells_of(12, {});
  const PublishedCompletion completion(cells, std::nullopt, kSpacing, 1);
  test::Random random(2);
  for (const Eigen::Vector3d& p : random_points(random, 200))
    for (const auto& [label, share] : filled(completion, cells.locate(p), p))
      CHECK(share == (label == kOutside ? 1 : 0));
}

TEST_CASE("completion: the field is continuous across walls with unknown parts, whatever the cells see") {
  const CellComplex cells = cells_of(20, test::body());
  for (const std::optional<int> hops : {std::optional(1), std::optional<int>()}) {
    const PublishedCompletion completion(cells, hops, kSpacing, 2);
    test::Random random(3);
    double sum = 0, largest = 0;
    int walls = 0, mixed = 0;
    std::vector<CellFace> faces;
    for (int round = 0; round < 1500; ++round) {
      const Eigen::Vector3d inside = random_points(random, 1).front();
      const CellId cell = cells.locate(inside);
      cells.faces(cell, faces);
      const CellFace& face = faces[random() % faces.size()];
      Eigen::Vector3d foot = face.image_to_reference->inverse() * inside;
      foot.z() = 1e-5;
      const Eigen::Vector3d above = *face.image_to_reference * foot;
      const Eigen::Vector3d below = above - 2e-5 * face.image_to_reference->linear().col(2);
      const CellId upper = cells.locate(above), lower = cells.locate(below);
      if (upper == lower || (upper != cell && lower != cell)) continue;
      const auto from_above = field(cells, completion, upper, above);
      const double jump = largest_difference(from_above, field(cells, completion, lower, below));
      sum += jump;
      largest = std::max(largest, jump);
      ++walls;
      mixed += from_above.at(kOutside) > 0.05 && from_above.at(kOutside) < 0.95;
    }
    MESSAGE(walls << " places, " << mixed << " of more than one label: mean jump " << sum / walls << ", largest "
                  << largest);
    CHECK(mixed > 60);
    CHECK(sum / walls < 1e-5);
    CHECK(largest < 1e-3);
  }
}

TEST_CASE("completion: it does not depend on the unit of length") {
  constexpr double kScale = 1024;
  const CellComplex cells = cells_of(12, test::body()), large = cells_of(12, test::body(), kScale);
  const PublishedCompletion completion(cells, 2, kSpacing, 1), of_large(large, 2, kSpacing * kScale, 1);
  test::Random random(4);
  double largest = 0;
  for (const Eigen::Vector3d& p : random_points(random, 200))
    largest = std::max(largest, largest_difference(filled(completion, cells.locate(p), p),
                                                   filled(of_large, large.locate(kScale * p), kScale * p)));
  MESSAGE("largest difference: " << largest);
  CHECK(largest < 1e-6);
}

TEST_CASE("completion: as many hops as there are cells are no limit; the number of threads changes no bit") {
  const CellComplex cells = cells_of(10, test::body());
  const PublishedCompletion all(cells, std::nullopt, kSpacing, 1), far(cells, 1000, kSpacing, 2),
      again(cells, std::nullopt, kSpacing, 2);
  test::Random random(5);
  for (const Eigen::Vector3d& p : random_points(random, 100)) {
    const auto shares = filled(all, cells.locate(p), p);
    CHECK(largest_difference(shares, filled(far, cells.locate(p), p)) < 1e-6);
    CHECK(largest_difference(shares, filled(again, cells.locate(p), p)) == 0);
  }
}
