#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "core/cells/cell_complex.h"
#include "core/field/field_evaluator.h"
#include "core/slopes/contour_slopes.h"
#include "tests/support/planes.h"

using namespace sonoloft;

namespace {

constexpr double kFeature = 1;  // mm; an object of 60 mm

/// Slices, and the field between them with contours as they are and as they move.
class Between {
 public:
  explicit Between(const std::vector<Section>& sections)
      : cells_({Eigen::Vector3d::Constant(-400), Eigen::Vector3d::Constant(400)}, 1e-3), slopes_(kFeature) {
    for (const Section& section : sections) {
      const auto delta = cells_.insert(section);
      REQUIRE(delta);
      slopes_.note(*delta);
    }
    static_cast<void>(slopes_.update(cells_, 1));
  }

  /// Where label 1 ends on the way from a point in it along a direction, mm.
  [[nodiscard]] double way_out(const Eigen::Vector3d& from, const Eigen::Vector3d& along, bool moving) const {
    double inside = 0, outside = 40;
    while (outside - inside > 1e-4) {
      const double middle = 0.5 * (inside + outside);
      (share(from + middle * along, moving) > 0.5f ? inside : outside) = middle;
    }
    return inside;
  }

  /// What label 1 has of a point.
  [[nodiscard]] float share(const Eigen::Vector3d& point, bool moving) const {
    const CellId id = cells_.locate(point);
    std::vector<CellFace> faces;
    cells_.faces(id, faces);
    std::vector<FaceBends> bends;
    for (const CellFace& face : faces) {
      const auto slice = moving ? cells_.slice_of(face.plane) : std::nullopt;
      bends.push_back(slice ? FaceBends{&cells_.section(*slice), slopes_.bends(*slice)} : FaceBends{});
    }
    FieldBatch batch;
    const std::uint32_t index = batch.cells.add(faces, cells_.centre(id), {}, bends);
    const auto labels = batch.cells.labels(index);
    const auto slot = std::find(labels.begin(), labels.end(), Label{1});
    if (slot == labels.end()) return 0;
    if (batch.cells.constant(index)) return 1;
    batch.add_points(index, {&point, 1});
    REQUIRE(make_cpu_evaluator(1)->evaluate(batch));
    return batch.row(0, static_cast<std::uint32_t>(slot - labels.begin()))[0];
  }

 private:
  CellComplex cells_;
  ContourSlopes slopes_;
};

Section disc(double z, double radius) {
  return test::section_of_discs(test::frame_at({0, 0, z}, {0, 0, 1}), {{{0, 0}, radius, 1}}, 400);
}

/// A rectangle of label 1 that ends along the line through (offset, 0) of the image, straight up.
Section half(const Eigen::Isometry3d& frame, double offset) {
  Section section;
  section.image_to_reference = frame;
  constexpr int kParts = 200;
  constexpr double kFar = 120;
  for (int i = 0; i <= kParts; ++i) section.points.emplace_back(offset, kFar * (2.0 * i / kParts - 1));
  section.points.emplace_back(-kFar, kFar);
  section.points.emplace_back(-kFar, -kFar);
  for (std::uint32_t i = 0; i < section.points.size(); ++i)
    section.edges.push_back({i, static_cast<std::uint32_t>((i + 1) % section.points.size()), 1, kOutside});
  return section;
}

}  // namespace

TEST_CASE("smooth field: a cylinder between two slices across it keeps its radius, which the published field shrinks") {
  const Between between({disc(-3, 10), disc(3, 10)});
  for (const double z : {-2.0, -1.0, 0.0, 1.5}) {
    const double smooth = between.way_out({0, 0, z}, {1, 0, 0}, true);
    const double step = between.way_out({0, 0, z}, {1, 0, 0}, false);
    CAPTURE(z);
    CAPTURE(smooth);
    CAPTURE(step);
    CHECK(std::abs(smooth - 10) < 0.02);
    CHECK(std::abs(step - 10) > 0.09);
  }
}

TEST_CASE("smooth field: a cone through three circles stays straight between them") {
  const auto radius = [](double z) { return 12 - 0.8 * z; };
  const Between between({disc(-6, radius(-6)), disc(0, radius(0)), disc(6, radius(6))});
  double smooth = 0, step = 0;
  for (const double z : {-4.5, -3.0, -1.5, 1.5, 3.0, 4.5}) {
    smooth = std::max(smooth, std::abs(between.way_out({0, 0, z}, {1, 0, 0}, true) - radius(z)));
    step = std::max(step, std::abs(between.way_out({0, 0, z}, {1, 0, 0}, false) - radius(z)));
  }
  MESSAGE("off by up to " << smooth << " mm, as published by " << step);
  CHECK(smooth < 0.25 * step);
  CHECK(smooth < 0.35);
}

TEST_CASE("smooth field: a tilted plane in a wedge of two slices stays a plane") {
  // The slices meet in the line x = z = 0 and open by 40 degrees; the border goes through the point (20, 0, 0), leaning
  // by 20 degrees.
  const double half_angle = std::numbers::pi / 9, lean = std::tan(half_angle);
  std::vector<Section> sections;
  for (const double side : {-1.0, 1.0}) {
    Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
    frame.linear() = Eigen::AngleAxisd(-side * half_angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
    // x = 20 + lean * z meets the slice at x = r cos, z = side r sin.
    sections.push_back(half(frame, 20 / (std::cos(half_angle) - side * lean * std::sin(half_angle))));
  }
  const Between between(sections);
  double smooth = 0, step = 0;
  for (const double z : {-4.0, -2.0, 0.0, 2.0, 4.0}) {
    const Eigen::Vector3d from(14, 0, z);
    const double true_way = 20 + lean * z - 14;
    smooth = std::max(smooth, std::abs(between.way_out(from, {1, 0, 0}, true) - true_way));
    step = std::max(step, std::abs(between.way_out(from, {1, 0, 0}, false) - true_way));
  }
  MESSAGE("off by up to " << smooth << " mm, as published by " << step);
  CHECK(smooth < 0.3 * step);
}

TEST_CASE("smooth field: on the slices themselves it is what they show") {
  const Between between({disc(-6, 8), disc(0, 11), disc(6, 9)});
  for (const double z : {-6.0, 0.0, 6.0})
    for (const double side : {-1e-4, 1e-4}) {
      const double radius = z == 0 ? 11 : z < 0 ? 8 : 9;
      CHECK(std::abs(between.way_out({0, 0, z + side}, {1, 0, 0}, true) - radius) < 2e-3);
    }
}
