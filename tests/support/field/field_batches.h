#pragma once
#include <cmath>
#include <cstring>
#include <numeric>
#include <span>
#include <vector>

#include "core/field/field_batch.h"
#include "tests/support/field/field_cells.h"

namespace sonoloft::test {

/// The label at a point of a labelled face, and how far the nearest border or outline is.
inline std::pair<Label, double> label_and_border_distance(const FacePolygon& polygon, const Eigen::Vector2d& p) {
  double nearest = 1e300;
  Label label = kBeyondFace;
  for (const FaceEdge& e : polygon) {
    const Eigen::Vector2d along = e.b - e.a;
    const double t = std::clamp((p - e.a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    const double distance = (e.a + t * along - p).norm();
    if (distance >= nearest) continue;
    nearest = distance;
    // Seen from the nearest end of a piece the side may mislead; from within the piece it does not.
    const double side = along.x() * (p - e.a).y() - along.y() * (p - e.a).x();
    label = side > 0 ? e.left : e.right;
    if (t == 0 || t == 1) label = kBeyondFace;
  }
  return {label, label == kBeyondFace ? 0 : nearest};
}

/// The same points of the same cells twice: in order, one block a cell; and in random order, in blocks of random
/// lengths, those of different cells mixed.
class ShuffledBatches {
 public:
  ShuffledBatches(Random& random, std::span<const Label> labels) {
    for (std::uint32_t c = 0; c < 20; ++c) {
      const FieldCell cell(random_walls(random, 4 + static_cast<int>(c % 12), labels, 10, 30.0));
      std::vector<Eigen::Vector3d> points(100 + random() % 50);
      for (std::size_t i = 0; i < points.size(); ++i) {
        points[i] = cell.random_point(random);
        // Every second one close to a wall, where neighbouring lanes take different ways.
        const Wall& wall = cell.walls()[random() % cell.walls().size()];
        const FaceEdge& e = wall.polygon[random() % wall.polygon.size()];
        const Eigen::Vector3d on_wall = wall.frame * Eigen::Vector3d(e.a.x(), e.a.y(), 0);
        if (i % 2 == 0) points[i] = on_wall + 1e-3 * (points[i] - on_wall);
      }
      straight.add_points(straight.cells.add(cell.faces(), cell.centre()), points);
      shuffled.cells.add(cell.faces(), cell.centre());
      cut(random, c, points);
    }
    std::shuffle(pieces_.begin(), pieces_.end(), random);
    for (Piece& piece : pieces_) piece.block = shuffled.add_points(piece.cell, piece.points);
  }

  FieldBatch straight, shuffled;

  /// Shares that the two batches do not agree on to the last bit. @pre both evaluated
  [[nodiscard]] int different_bits() const {
    int count = 0;
    for (const Piece& piece : pieces_)
      for (std::uint32_t slot = 0; slot < straight.cells.labels(piece.cell).size(); ++slot)
        for (std::size_t i = 0; i < piece.index.size(); ++i) {
          const float a = straight.row(piece.cell, slot)[piece.index[i]], b = shuffled.row(piece.block, slot)[i];
          if (std::memcmp(&a, &b, sizeof a) != 0) ++count;
        }
    return count;
  }

 private:
  struct Piece {
    std::uint32_t cell, block;
    std::vector<std::size_t> index;  ///< of its points in the straight block
    std::vector<Eigen::Vector3d> points;
  };

  void cut(Random& random, std::uint32_t cell, const std::vector<Eigen::Vector3d>& points) {
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::shuffle(order.begin(), order.end(), random);
    for (std::size_t first = 0; first < order.size();) {
      Piece& piece = pieces_.emplace_back(Piece{cell, 0, {}, {}});
      for (std::size_t n = 1 + random() % 40; n > 0 && first < order.size(); --n, ++first) {
        piece.index.push_back(order[first]);
        piece.points.push_back(points[order[first]]);
      }
    }
  }

  std::vector<Piece> pieces_;
};

}  // namespace sonoloft::test
