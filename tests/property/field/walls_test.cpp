#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <random>

#include "core/background/background.h"
#include "core/background/rim.h"
#include "core/field/reference.h"
#include "tests/support/view_slices.h"

using namespace sonoloft;

namespace {

constexpr Label kUnknownOfFace = 50000;  ///< and the face's index

/// The faces with the unknown part of each labelled as its own. @param polygons  out, holds what they point to
std::vector<CellFace> told_apart(std::vector<CellFace> faces, std::vector<FacePolygon>& polygons) {
  polygons.clear();
  for (const CellFace& face : faces) polygons.push_back(*face.polygon);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (FaceEdge& e : polygons[i])
      for (Label* label : {&e.left, &e.right})
        if (*label == kUnknown) *label = static_cast<Label>(kUnknownOfFace + i);
    faces[i].polygon = &polygons[i];
  }
  return faces;
}

/// Known shares, and of the unknown part of every wall what its slice's rim and the background say.
std::map<Label, double> filled_field(const CellComplex& cells, const Background& background,
                                     const std::map<SliceId, Rim>& rims, const Eigen::Vector3d& p) {
  std::vector<CellFace> faces;
  std::vector<FacePolygon> polygons;
  cells.faces(cells.locate(p), faces);
  faces = told_apart(std::move(faces), polygons);
  PointShares fill;
  background.shares({&p, 1}, fill);
  std::map<Label, double> field;
  for (const auto& [label, share] : reference_shares(faces, p, 1e-9).shares) {
    if (label < kUnknownOfFace) {
      field[label] += share;
      continue;
    }
    PointWeights rim;
    if (const auto slice = cells.slice_of(faces[label - kUnknownOfFace].plane)) rims.at(*slice).weigh({&p, 1}, rim);
    double total = 1;
    for (const float weight : rim.weight) total += static_cast<double>(weight);
    for (std::size_t l = 0; l < rim.labels.size(); ++l)
      field[rim.labels[l]] += share * static_cast<double>(rim.weight[l]) / total;
    for (std::size_t l = 0; l < fill.labels.size(); ++l)
      field[fill.labels[l]] += share * static_cast<double>(fill.share[l]) / total;
  }
  return field;
}

}  // namespace

TEST_CASE("field: with background and rims it is continuous across walls, those that face several cells among them") {
  const Eigen::AlignedBox3d box(Eigen::Vector3d::Constant(-130), Eigen::Vector3d::Constant(130));
  CellComplex cells(box, 0.2);
  Background background(box, 5);
  std::map<SliceId, Rim> rims;
  const auto frames = test::hand_sweep(1000, 3);
  for (std::size_t i = 0; i < frames.size(); i += 20) {
    const Section section = test::checked_section(test::slice_of_balls(frames[i], test::body(), test::sector_view()));
    const auto delta = cells.insert(section);
    REQUIRE(delta);
    background.add(section);
    rims.emplace(delta->slice, Rim(section, background.spacing_mm()));
  }
  (void)background.update(2);

  constexpr double kOff_mm = 0.00002;
  std::mt19937 rng(4);
  std::uniform_real_distribution<double> uniform(0.02, 0.98);
  std::vector<CellFace> faces;
  double sum = 0, largest = 0;
  int points = 0, with_unknown = 0;
  for (std::uint32_t c = 0; c < cells.cell_bound(); ++c) {
    cells.faces(CellId{c}, faces);
    for (const CellFace& face : faces) {
      if (static_cast<std::uint32_t>(face.plane) < 6 || face.polygon->empty() || !face.above) continue;
      const FacePolygon& polygon = *face.polygon;
      const Eigen::Vector2d a = polygon[rng() % polygon.size()].a, b = polygon[rng() % polygon.size()].a,
                            d = polygon[rng() % polygon.size()].a;
      const double s = uniform(rng), t = uniform(rng);
      const Eigen::Vector2d q = a + s * (b - a) + (1 - s) * t * (d - a);
      const Eigen::Vector3d upper = *face.image_to_reference * Eigen::Vector3d(q.x(), q.y(), kOff_mm);
      const Eigen::Vector3d lower = *face.image_to_reference * Eigen::Vector3d(q.x(), q.y(), -kOff_mm);
      if (cells.locate(upper) != CellId{c} || cells.locate(lower) == CellId{c}) continue;
      const bool beside_border = std::any_of(polygon.begin(), polygon.end(), [&](const FaceEdge& e) {
        const Eigen::Vector2d along = e.b - e.a;
        const double at = std::clamp((q - e.a).dot(along) / along.squaredNorm(), 0.0, 1.0);
        return (e.a + at * along - q).norm() < 0.5;
      });
      if (beside_border) continue;  // there the field is steep
      auto above = filled_field(cells, background, rims, upper), below = filled_field(cells, background, rims, lower);
      double jump = 0;
      for (const Label label : {Label{0}, Label{1}, Label{2}})
        jump = std::max(jump, std::abs(above[label] - below[label]));
      sum += jump;
      largest = std::max(largest, jump);
      ++points;
      with_unknown += face.label == kUnknown;
    }
  }
  MESSAGE(points << " points on walls, " << with_unknown << " of these unknown: mean jump " << sum / points
                 << ", largest " << largest);
  CHECK(points > 300);
  CHECK(with_unknown > 50);
  CHECK(sum / points <= 1e-5);
  CHECK(largest < 1e-2);
}
