#pragma once
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "core/slice/section.h"

/// Planes and sections for tests, without the way through contours.
namespace sonoloft::test {

inline Eigen::Isometry3d frame_at(const Eigen::Vector3d& origin, const Eigen::Vector3d& normal) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  frame.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal).toRotationMatrix();
  frame.translation() = origin;
  return frame;
}

inline Eigen::Vector3d random_direction(std::mt19937& rng) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (;;) {
    const Eigen::Vector3d d(uniform(rng), uniform(rng), uniform(rng));
    if (d.squaredNorm() > 0.01 && d.squaredNorm() <= 1.0) return d.normalized();
  }
}

/// A plane through a random point of the cube of half-width `spread`.
inline Eigen::Isometry3d random_frame(std::mt19937& rng, double spread) {
  std::uniform_real_distribution<double> uniform(-spread, spread);
  const Eigen::Vector3d origin(uniform(rng), uniform(rng), uniform(rng));
  return frame_at(origin, random_direction(rng));
}

/// A section with discs (regular polygons of n sides) that do not touch each other, each with its label.
struct Disc {
  Eigen::Vector2d centre;
  double radius;
  Label label;
};

inline Section section_of_discs(const Eigen::Isometry3d& frame, const std::vector<Disc>& discs, int sides = 48) {
  Section section;
  section.image_to_reference = frame;
  for (const Disc& disc : discs) {
    const auto first = static_cast<std::uint32_t>(section.points.size());
    for (int i = 0; i < sides; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / sides;
      section.points.push_back(disc.centre + disc.radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
      const auto a = first + static_cast<std::uint32_t>(i);
      const auto b = first + static_cast<std::uint32_t>((i + 1) % sides);
      section.edges.push_back({a, b, disc.label, kOutside});
    }
  }
  return section;
}

/// Nothing outside of the discs was seen.
inline void bound_view(Section& section) {
  for (SectionEdge& e : section.edges) e.right = kUnknown;
  section.border = kUnknown;
}

}  // namespace sonoloft::test
