#pragma once
// What a phantom's section says and whether it is well formed, without the code that traced it.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "device_sim/probe/phantom.h"
#include "device_sim/probe/random.h"

namespace sonoloft::test {

inline std::span<const Eigen::Vector2d> points_of(const device_sim::PhantomSection& section,
                                                  const device_sim::SectionLoop& loop) {
  return std::span(section.points).subspan(loop.first, loop.count);
}

inline bool inside_loop(std::span<const Eigen::Vector2d> loop, const Eigen::Vector2d& p) {
  bool inside = false;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Eigen::Vector2d &a = loop[i], &b = loop[(i + 1) % loop.size()];
    if ((a.x() <= p.x()) != (b.x() <= p.x()) && p.y() < a.y() + (b.y() - a.y()) * (p.x() - a.x()) / (b.x() - a.x()))
      inside = !inside;
  }
  return inside;
}

inline double loop_area(std::span<const Eigen::Vector2d> loop) {
  double twice = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Eigen::Vector2d a = loop[i] - loop[0], b = loop[(i + 1) % loop.size()] - loop[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return std::abs(twice) / 2;
}

/// The smallest loop around the point decides.
inline device_sim::Label label_in_section(const device_sim::PhantomSection& section, const Eigen::Vector2d& p) {
  double smallest = std::numeric_limits<double>::infinity();
  device_sim::Label label = device_sim::kOutside;
  for (const device_sim::SectionLoop& loop : section.loops) {
    const auto points = points_of(section, loop);
    const double area = loop_area(points);
    if (area >= smallest || !inside_loop(points, p)) continue;
    smallest = area;
    label = loop.hole ? device_sim::kOutside : loop.label;
  }
  return label;
}

/// Area with this label: its loops less what lies in them, by even-odd counting along fine lines.
inline double label_area(const device_sim::PhantomSection& section, device_sim::Label label, int lines = 2000) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& p : section.points) box.extend(p);
  if (box.isEmpty()) return 0;
  const double step = box.sizes().x() / lines;
  double area = 0;
  for (int i = 0; i < lines; ++i) {
    const double x = box.min().x() + (i + 0.5) * step;
    std::vector<double> y;
    for (const device_sim::SectionLoop& loop : section.loops) {
      const auto p = points_of(section, loop);
      for (std::size_t k = 0; k < p.size(); ++k) {
        const Eigen::Vector2d &a = p[k], &b = p[(k + 1) % p.size()];
        if ((a.x() <= x) != (b.x() <= x)) y.push_back(a.y() + (b.y() - a.y()) * (x - a.x()) / (b.x() - a.x()));
      }
    }
    std::sort(y.begin(), y.end());
    for (std::size_t k = 0; k + 1 < y.size(); ++k)
      if (y[k + 1] - y[k] > 1e-12 && label_in_section(section, {x, (y[k] + y[k + 1]) / 2}) == label)
        area += (y[k + 1] - y[k]) * step;
  }
  return area;
}

/// Loops one after the other, at least 3 points, finite, an area, no point twice in a row, holes without a label.
inline bool well_formed(const device_sim::PhantomSection& section) {
  std::size_t next = 0;
  for (const device_sim::SectionLoop& loop : section.loops) {
    if (loop.first != next || loop.count < 3 || next + loop.count > section.points.size()) return false;
    if (loop.hole != (loop.label == device_sim::kOutside)) return false;
    const auto points = points_of(section, loop);
    if (!(loop_area(points) > 0)) return false;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (!points[i].allFinite() || points[i] == points[(i + 1) % points.size()]) return false;
    next += loop.count;
  }
  return next == section.points.size();
}

inline double distance_to_borders(const device_sim::PhantomSection& section, const Eigen::Vector2d& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const device_sim::SectionLoop& loop : section.loops) {
    const auto points = points_of(section, loop);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector2d &a = points[i], d = points[(i + 1) % points.size()] - a;
      const double t = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (p - a - t * d).norm());
    }
  }
  return nearest;
}

/// A plane through a point; its pose has no rounding where the normal is an axis.
inline Eigen::Isometry3d plane_at(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  const Eigen::Vector3d z = normal.normalized(), x = z.unitOrthogonal();
  Eigen::Isometry3d plane = Eigen::Isometry3d::Identity();
  plane.linear() << x, z.cross(x), z;
  plane.translation() = point;
  return plane;
}

inline Eigen::Vector3d random_point(const Eigen::AlignedBox3d& box, device_sim::Random& random) {
  Eigen::Vector3d point;
  for (int a = 0; a < 3; ++a) point[a] = box.min()[a] + random.uniform() * box.sizes()[a];
  return point;
}

/// A plane of any direction through a random point of the box.
inline Eigen::Isometry3d random_plane(const Eigen::AlignedBox3d& box, device_sim::Random& random) {
  const Eigen::Vector3d point = random_point(box, random);
  Eigen::Quaterniond turn;
  turn.vec() = random.normal3();
  turn.w() = random.normal();
  return Eigen::Translation3d(point) * turn.normalized();
}

/// Share of random points of the plane, farther than `clear_mm` from a border, at which section and phantom agree; with
/// a window, of points in it, by the section in it.
struct Agreement {
  int points = 0;
  int agreed = 0;
};
inline Agreement agreement(const device_sim::Phantom& phantom, const Eigen::Isometry3d& plane, double clear_mm,
                           int tries, device_sim::Random& random,
                           const std::optional<Eigen::AlignedBox2d>& window = {}) {
  const device_sim::PhantomSection section = window ? phantom.section_in(*window, plane) : phantom.section(plane);
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : device_sim::box_section(phantom.bounds(), plane)) box.extend(corner);
  if (window) box = box.intersection(*window);
  Agreement result;
  for (int i = 0; i < tries && !box.isEmpty(); ++i) {
    Eigen::Vector2d p = box.min();
    for (int a = 0; a < 2; ++a) p[a] += random.uniform() * box.sizes()[a];
    if (distance_to_borders(section, p) <= clear_mm) continue;
    ++result.points;
    result.agreed += label_in_section(section, p) == phantom.label_at(plane * Eigen::Vector3d(p.x(), p.y(), 0));
  }
  return result;
}

}  // namespace sonoloft::test
