#pragma once
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include "core/cells/cell_complex.h"
#include "core/cells/face_polygon.h"
#include "core/field/packing/bent_face.h"

/// Convex cells with labelled walls, made without a complex: for tests and benches of the field.
namespace sonoloft::test {

using Random = std::mt19937_64;

inline double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

inline Eigen::Vector3d uniform_direction(Random& random) {
  std::normal_distribution<double> normal;
  return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
}

/// A labelled plane; `polygon` reaches farther than any cell that it bounds.
struct Wall {
  Eigen::Isometry3d frame;  ///< image to reference
  bool above;               ///< the cell lies on the side of the normal
  FacePolygon polygon;
  Section section;                ///< that the borders are pieces of, when these are to move; else empty
  std::vector<VertexBend> bends;  ///< [section.points]
};

/// A closed loop: `inside` left of it and `around` right of it.
inline void add_loop(FacePolygon& polygon, const std::vector<Eigen::Vector2d>& loop, Label inside, Label around) {
  for (std::size_t i = 0; i < loop.size(); ++i)
    polygon.push_back({loop[i], loop[(i + 1) % loop.size()], inside, around});
}

/// `points` long non-convex rings around a point near the image's origin, each with a label of its own, the innermost
/// cut into sectors; `around` outside of them all.
inline FacePolygon random_rings(Random& random, std::span<const Label> labels, int points, double scale_mm) {
  const auto label = [&] { return labels[random() % labels.size()]; };
  FacePolygon polygon;
  Label around = label();
  const double far = 9 * scale_mm;
  add_loop(polygon, {{-far, -far}, {far, -far}, {far, far}, {-far, far}}, around, kBeyondFace);

  const Eigen::Vector2d middle = scale_mm * Eigen::Vector2d(uniform(random, -0.4, 0.4), uniform(random, -0.4, 0.4));
  std::vector<Eigen::Vector2d> spokes(static_cast<std::size_t>(points));
  const double turn = uniform(random, 0, 2 * std::numbers::pi);
  for (int i = 0; i < points; ++i) {
    const double angle = turn + 2 * std::numbers::pi * i / points;
    spokes[static_cast<std::size_t>(i)] =
        scale_mm * uniform(random, 0.25, 0.8) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  const auto ring = [&](double factor) {
    std::vector<Eigen::Vector2d> loop(spokes.size());
    std::transform(spokes.begin(), spokes.end(), loop.begin(),
                   [&](const Eigen::Vector2d& spoke) -> Eigen::Vector2d { return middle + factor * spoke; });
    return loop;
  };
  for (const double factor : {1.0, 0.7}) {
    const Label inside = label();
    if (inside != around) add_loop(polygon, ring(factor), inside, around);
    around = inside;
  }
  const std::vector<Eigen::Vector2d> core = ring(0.4);
  std::vector<Label> sectors(core.size());
  for (std::size_t i = 0; i < core.size(); ++i) sectors[i] = i % 4 == 0 ? label() : sectors[i - 1];
  for (std::size_t i = 0; i < core.size(); ++i) {
    const std::size_t next = (i + 1) % core.size();
    if (sectors[i] != around) polygon.push_back({core[i], core[next], sectors[i], around});
    if (sectors[i] != sectors[next]) polygon.push_back({middle, core[next], sectors[next], sectors[i]});
  }
  return polygon;
}

/// A wall of a cell around the origin; which way the plane's normal points is left to chance.
inline Wall random_wall(Random& random, const Eigen::Vector3d& outward, double distance_mm, FacePolygon polygon) {
  Wall wall{Eigen::Isometry3d::Identity(), random() % 2 == 0, std::move(polygon), {}, {}};
  wall.frame.linear() = (Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), wall.above ? -outward : outward) *
                         Eigen::AngleAxisd(uniform(random, 0, 6), Eigen::Vector3d::UnitZ()))
                            .toRotationMatrix();
  wall.frame.translation() = distance_mm * outward;
  return wall;
}

/// Makes the borders of a wall, not yet clipped, move with the height over it: slopes up to 2, curvatures up to
/// 4 / scale_mm.
inline void bend_borders(Wall& wall, Random& random, double scale_mm) {
  Section& section = wall.section;
  const auto index_of = [&](const Eigen::Vector2d& p) {
    const auto at = std::find(section.points.begin(), section.points.end(), p);
    if (at == section.points.end()) {
      section.points.push_back(p);
      const Eigen::Vector2d outward = uniform_direction(random).head<2>().normalized();
      wall.bends.push_back({outward.cast<float>(), static_cast<float>(uniform(random, -2, 2)),
                            static_cast<float>(uniform(random, -4, 4) / scale_mm),
                            static_cast<float>(uniform(random, 0, 4) / scale_mm)});
      return static_cast<std::uint32_t>(section.points.size() - 1);
    }
    return static_cast<std::uint32_t>(at - section.points.begin());
  };
  for (FaceEdge& e : wall.polygon) {
    if (e.right == kBeyondFace) continue;
    e.source = static_cast<std::uint32_t>(section.edges.size());
    section.edges.push_back({index_of(e.a), index_of(e.b), e.left, e.right});
  }
}

/// `count` walls (4 and more, not all of which need touch the cell) around the origin; the first four close it.
inline std::vector<Wall> random_walls(Random& random, int count, std::span<const Label> labels, int ring_points,
                                      double scale_mm) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(uniform(random, 0, 3), uniform_direction(random)));
  const Eigen::Vector3d tetrahedron[] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  std::vector<Wall> walls;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d tilt = uniform_direction(random);
    const Eigen::Vector3d outward = i < 4 ? (turn * (tetrahedron[i] + 0.3 * tilt)).normalized() : tilt;
    const double distance_mm = scale_mm * uniform(random, 0.3, i < 4 ? 0.5 : 0.7);
    walls.push_back(random_wall(random, outward, distance_mm, random_rings(random, labels, ring_points, scale_mm)));
  }
  return walls;
}

/// A cell that owns what CellFace only points to.
class FieldCell {
 public:
  /// The part of space that all walls leave, moved by `shift_mm`. @pre bounded, not empty
  explicit FieldCell(const std::vector<Wall>& walls, const Eigen::Vector3d& shift_mm = Eigen::Vector3d::Zero()) {
    for (std::size_t i = 0; i < walls.size(); ++i) {
      Wall wall = walls[i];
      for (std::size_t j = 0; j < walls.size(); ++j)
        if (j != i) clip(wall, walls[j]);
      if (wall.polygon.empty()) continue;
      wall.frame.translation() += shift_mm;
      walls_.push_back(std::move(wall));
    }
    measure();
  }

  /// Valid while the cell lives.
  [[nodiscard]] std::vector<CellFace> faces() const {
    std::vector<CellFace> faces;
    for (const Wall& wall : walls_) {
      const auto plane = PlaneId{static_cast<std::uint32_t>(faces.size())};
      faces.push_back({&wall.frame, plane, wall.above, kBeyondFace, &wall.polygon});
    }
    return faces;
  }
  /// [faces()] Valid while the cell lives.
  [[nodiscard]] std::vector<FaceBends> bends() const {
    std::vector<FaceBends> bends;
    for (const Wall& wall : walls_) bends.push_back({&wall.section, wall.bends});
    return bends;
  }
  [[nodiscard]] const std::vector<Wall>& walls() const { return walls_; }
  [[nodiscard]] const Eigen::Vector3d& centre() const { return centre_; }
  [[nodiscard]] double size_mm() const { return size_mm_; }  ///< diameter around the centre

  /// Distance to the nearest wall, negative outside.
  [[nodiscard]] double depth(const Eigen::Vector3d& point) const {
    double nearest = size_mm_;
    for (const Wall& wall : walls_) {
      const double z = (wall.frame.inverse() * point).z();
      nearest = std::min(nearest, wall.above ? z : -z);
    }
    return nearest;
  }

  [[nodiscard]] Eigen::Vector3d random_point(Random& random) const {
    for (;;) {
      const double r = 0.5 * size_mm_;
      const Eigen::Vector3d p =
          centre_ + Eigen::Vector3d(uniform(random, -r, r), uniform(random, -r, r), uniform(random, -r, r));
      if (depth(p) > 0) return p;
    }
  }

 private:
  /// Takes from the wall's polygon what lies beyond another wall's plane.
  static void clip(Wall& wall, const Wall& other) {
    const Eigen::Vector3d outward = (other.above ? -1.0 : 1.0) * other.frame.linear().col(2);
    const Eigen::Vector3d n = wall.frame.linear().transpose() * outward;
    const double offset_mm = outward.dot(wall.frame.translation() - other.frame.translation());
    const double length = n.head<2>().norm();
    if (length < 1e-9) return;  // parallel, and both bound the cell
    wall.polygon = split(wall.polygon, {n.head<2>() / length, offset_mm / length}).first;
  }

  void measure() {
    std::vector<Eigen::Vector3d> corners;
    for (const Wall& wall : walls_)
      for (const FaceEdge& e : wall.polygon)
        if (e.right == kBeyondFace) corners.push_back(wall.frame * Eigen::Vector3d(e.a.x(), e.a.y(), 0));
    for (const Eigen::Vector3d& corner : corners) centre_ += corner / static_cast<double>(corners.size());
    for (const Eigen::Vector3d& corner : corners) size_mm_ = std::max(size_mm_, 2 * (corner - centre_).norm());
  }

  std::vector<Wall> walls_;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  double size_mm_ = 0;
};

}  // namespace sonoloft::test
