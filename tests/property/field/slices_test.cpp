#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/cells/cell_complex.h"
#include "core/field/field_evaluator.h"
#include "tests/support/planes.h"

using namespace sonoloft;

namespace {

/// Four discs, one of them a shadow; a ring of label 3 around the second.
Section slice_of_discs(const Eigen::Isometry3d& frame) {
  struct Disc {
    Eigen::Vector2d centre;
    double radius;
    Label label;
  };
  TrackedSlice slice;
  slice.image_to_reference = frame;
  for (const Disc& disc : {Disc{{-8, 0}, 7, 1}, Disc{{8, 2}, 6, 3}, Disc{{8, 1}, 4, 2}, Disc{{0, 16}, 5, 1},
                           Disc{{2, -15}, 4, kUnknown}}) {
    slice.contours.push_back({static_cast<std::uint32_t>(slice.points.size()), 40, disc.label, false});
    for (int i = 0; i < 40; ++i) {
      const double angle = 2 * std::numbers::pi * i / 40;
      slice.points.push_back(disc.centre + disc.radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
  }
  const Result<Section> section = make_section(slice);
  REQUIRE(section);
  return *section;
}

/// Distance from a point of the image to the nearest border of the section.
double border_distance(const Section& section, const Eigen::Vector2d& p) {
  double nearest = 1e300;
  for (const SectionEdge& e : section.edges) {
    const Eigen::Vector2d a = section.points[e.a], along = section.points[e.b] - a;
    const double t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (a + t * along - p).norm());
  }
  return nearest;
}

/// The label with the largest share at a point of the complex, and that share.
std::pair<Label, float> field_at(const CellComplex& cells, FieldEvaluator& evaluator, const Eigen::Vector3d& point) {
  const CellId id = cells.locate(point);
  std::vector<CellFace> faces;
  cells.faces(id, faces);
  FieldBatch batch;
  const std::uint32_t index = batch.cells.add(faces, cells.centre(id));
  if (batch.cells.constant(index)) return {batch.cells.labels(index)[0], 1.0f};
  batch.add_points(index, {&point, 1});
  REQUIRE(evaluator.evaluate(batch));
  std::pair<Label, float> best{kOutside, -1.0f};
  for (std::uint32_t slot = 0; slot < batch.cells.labels(index).size(); ++slot)
    if (batch.row(0, slot)[0] > best.second) best = {batch.cells.labels(index)[slot], batch.row(0, slot)[0]};
  return best;
}

}  // namespace

TEST_CASE("field: next to every slice, on both of its sides, the field is what the slice shows") {
  std::mt19937 rng(8);
  const Eigen::AlignedBox3d box(Eigen::Vector3d::Constant(-40), Eigen::Vector3d::Constant(40));
  CellComplex cells(box, 0.01);
  std::vector<Section> sections;
  for (int i = 0; i < 12; ++i) {
    sections.push_back(slice_of_discs(test::random_frame(rng, 10.0)));
    REQUIRE(cells.insert(sections.back()));
  }

  const auto evaluator = make_cpu_evaluator(1);
  std::uniform_real_distribution<double> uniform(-25, 25);
  int points = 0, known = 0;
  float lowest = 1;
  for (const Section& section : sections) {
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector2d p(uniform(rng), uniform(rng));
      const double off_mm = i % 2 == 0 ? 1e-4 : -1e-4;
      const Eigen::Vector3d point = section.image_to_reference * Eigen::Vector3d(p.x(), p.y(), off_mm);
      const bool crowded = std::any_of(sections.begin(), sections.end(), [&](const Section& other) {
        return &other != &section && std::abs((other.image_to_reference.inverse() * point).z()) < 0.1;
      });
      if (crowded || !box.contains(point) || border_distance(section, p) < 0.1) continue;
      const Label shown = label_at(section, p);
      const auto [label, share] = field_at(cells, *evaluator, point);
      CHECK(label == shown);
      lowest = std::min(lowest, share);
      ++points;
      known += label != kOutside && label != kUnknown ? 1 : 0;
    }
  }
  MESSAGE(points << " points 0.0001 mm off a slice, " << known << " of them in a material: least share " << lowest);
  CHECK(known > 200);
  CHECK(lowest > 0.99f);
}
