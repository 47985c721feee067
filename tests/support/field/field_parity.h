#pragma once
#include <doctest/doctest.h>

#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "core/field/field_evaluator.h"
#include "core/field/reference.h"
#include "tests/support/field/field_cells.h"

/// How far an evaluator is from the field in double precision, near everything that is hard.
namespace sonoloft::test {

enum class Near { interior, face, cell_edge, cell_corner, label_border, label_corner };
inline constexpr std::array<const char*, 6> kNearNames = {"interior",    "face",         "cell edge",
                                                          "cell corner", "label border", "label corner"};

struct ParityRow {
  Near near{};
  double distance = 0;  ///< in cell sizes
  int points = 0;
  double share_error = 0;  ///< largest
  double position_error =
      0;  ///< largest share error over the share's gradient (at least 0.1 per cell size), cell sizes
};

/// A point of the cell `distance_mm` from something of the kind; false when chance found none.
inline bool place_near(const FieldCell& cell, Random& random, Near near, double distance_mm, Eigen::Vector3d& point) {
  for (int attempt = 0; attempt < 20; ++attempt) {
    const Wall& wall = cell.walls()[random() % cell.walls().size()];
    const FaceEdge& edge = wall.polygon[random() % wall.polygon.size()];
    const FaceEdge& other = wall.polygon[random() % wall.polygon.size()];
    const bool border = near == Near::label_border || near == Near::label_corner;
    if (border == (edge.right == kBeyondFace)) continue;
    double t = uniform(random, 0.05, 0.95);
    if (near == Near::cell_corner || near == Near::label_corner) t = 0;
    Eigen::Vector2d on_plane = edge.a + t * (edge.b - edge.a);
    if (near == Near::face) on_plane += uniform(random, 0, 1) * (other.a - on_plane);
    const Eigen::Vector3d normal = (wall.above ? 1 : -1) * wall.frame.linear().col(2);
    Eigen::Vector3d away = near == Near::face ? normal : uniform_direction(random);
    if (away.dot(normal) < 0) away = -away;
    point = wall.frame * Eigen::Vector3d(on_plane.x(), on_plane.y(), 0) + distance_mm * away;
    if (near == Near::interior) point = cell.random_point(random);
    if (cell.depth(point) > 0) return true;
  }
  return false;
}

/// The exact field at a point of a cell and a step to either side of it along x, y and z.
class ExactField {
 public:
  ExactField(const FieldCell& cell, const std::vector<CellFace>& faces, const std::vector<FaceBends>& bends,
             const Eigen::Vector3d& point, double step_mm)
      : cell_(cell), faces_(faces), bends_(bends), point_(point), step_mm_(step_mm), here_(at(point)) {
    for (int k = 0; k < 6; ++k)
      around_[static_cast<std::size_t>(k)] =
          at(point + (k % 2 == 0 ? step_mm : -step_mm) * Eigen::Vector3d::Unit(k / 2));
  }

  [[nodiscard]] double share(Label label) const { return here_.share(label); }

  /// About the distance from the point to where the label has the share `value`, in cell sizes: by the gradient where
  /// that holds, else, near corners of the field, the radius of a ball that has such values in it.
  [[nodiscard]] double distance_to(double value, Label label) const {
    const auto slope = [&](std::size_t axis) {
      return (around_[2 * axis].share(label) - around_[2 * axis + 1].share(label)) / (2 * step_mm_);
    };
    // Where a share hardly changes, an error of it moves no surface: hence a least gradient of 0.1 per cell size.
    const double gradient = std::max(Eigen::Vector3d(slope(0), slope(1), slope(2)).norm() * cell_.size_mm(), 0.1);
    const double straight = std::abs(share(label) - value) / gradient;
    if (straight < 5e-6) return straight;
    for (double radius = 1e-7; radius < straight; radius *= 2)
      if (ball_has(value, label, radius * cell_.size_mm())) return radius;
    return straight;
  }

 private:
  [[nodiscard]] ReferenceShares at(const Eigen::Vector3d& point) const {
    return reference_shares(faces_, point, 1e-12 * cell_.size_mm(), bends_);
  }

  [[nodiscard]] bool ball_has(double value, Label label, double radius_mm) const {
    Random random(1);
    double low = share(label), high = low;
    for (int i = 0; i < 300; ++i) {
      const Eigen::Vector3d near = point_ + radius_mm * std::cbrt(uniform(random, 0, 1)) * uniform_direction(random);
      if (cell_.depth(near) <= 0) continue;
      const double share_there = at(near).share(label);
      low = std::min(low, share_there);
      high = std::max(high, share_there);
    }
    return low <= value && value <= high;
  }

  const FieldCell& cell_;
  const std::vector<CellFace>& faces_;
  const std::vector<FaceBends>& bends_;
  Eigen::Vector3d point_;
  double step_mm_;
  ReferenceShares here_;
  std::array<ReferenceShares, 6> around_;
};

/// Adds a block's errors to the row.
inline void compare(const FieldBatch& batch, std::uint32_t block, const FieldCell& cell,
                    const std::vector<Eigen::Vector3d>& points, ParityRow& row) {
  const std::vector<CellFace> faces = cell.faces();
  const std::vector<FaceBends> bends = cell.bends();
  const std::span<const Label> labels = batch.cells.labels(batch.blocks[block].cell);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ExactField exact(cell, faces, bends, points[i], 1e-3 * row.distance * cell.size_mm());
    for (std::uint32_t slot = 0; slot < labels.size(); ++slot) {
      const double share = batch.row(block, slot)[i];
      row.share_error = std::max(row.share_error, std::abs(share - exact.share(labels[slot])));
      row.position_error = std::max(row.position_error, exact.distance_to(share, labels[slot]));
    }
  }
  row.points += static_cast<int>(points.size());
}

enum class Borders { stay, move };

/// Random cells of 4 to 18 walls, 0.01 to 100 mm across, with 4 labels and unknown parts.
inline std::vector<ParityRow> measure_parity(FieldEvaluator& evaluator, Borders borders) {
  const std::array<Label, 5> labels = {0, 1, 2, 7, kUnknown};
  std::vector<ParityRow> rows = {{Near::interior, 1e-2}};
  for (const Near near : {Near::face, Near::cell_edge, Near::cell_corner, Near::label_border, Near::label_corner})
    for (const double distance : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) rows.push_back({near, distance});
  Random random(20110813);
  for (int round = 0; round < 30; ++round) {
    const double scale_mm = std::pow(10.0, uniform(random, -2, 2));
    const int ring_points = 4 + static_cast<int>(random() % 12);
    const Eigen::Vector3d shift_mm = 10 * scale_mm * uniform_direction(random);
    std::vector<Wall> walls = random_walls(random, 4 + round % 15, labels, ring_points, scale_mm);
    if (borders == Borders::move)
      for (Wall& wall : walls) bend_borders(wall, random, scale_mm);
    const FieldCell cell(walls, shift_mm);
    FieldBatch batch;
    const std::uint32_t index = batch.cells.add(cell.faces(), cell.centre(), {}, cell.bends());
    if (batch.cells.constant(index)) continue;
    std::vector<std::vector<Eigen::Vector3d>> points(rows.size());
    for (std::size_t r = 0; r < rows.size(); ++r) {
      Eigen::Vector3d point;
      for (int i = 0; i < 12; ++i)
        if (place_near(cell, random, rows[r].near, rows[r].distance * cell.size_mm(), point))
          points[r].push_back(point);
      if (!points[r].empty()) batch.add_points(index, points[r]);
    }
    REQUIRE(evaluator.evaluate(batch));
    std::uint32_t block = 0;
    for (std::size_t r = 0; r < rows.size(); ++r)
      if (!points[r].empty()) compare(batch, block++, cell, points[r], rows[r]);
  }
  return rows;
}

/// Prints the table and holds every row to a displacement of 1e-5 of a cell.
inline void check_parity(FieldEvaluator& evaluator, Borders borders) {
  const std::vector<ParityRow> rows = measure_parity(evaluator, borders);
  std::string table = evaluator.name() + (borders == Borders::move ? ", borders move\n" : "\n");
  for (const ParityRow& row : rows) {
    char line[160];
    std::snprintf(line, sizeof line, "  %-12s at %.0e: %4d points, share error %.1e, position error %.1e\n",
                  kNearNames[static_cast<std::size_t>(row.near)], row.distance, row.points, row.share_error,
                  row.position_error);
    table += line;
    CAPTURE(line);
    CHECK(row.points > 100);
    CHECK(row.position_error <= 1e-5);
  }
  MESSAGE(table);
}

}  // namespace sonoloft::test
