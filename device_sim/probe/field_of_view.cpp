#include "device_sim/probe/field_of_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace sonoloft::device_sim {
namespace {

/// From the axis y towards x, which is how the sector's rays are counted.
double angle(const Eigen::Vector2d& p) {
  return std::atan2(p.x(), p.y());
}
double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Draws the reach of the rays that meet the edge a b in to that edge.
void cast_shadow(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double first_angle, double step, double near_mm,
                 std::vector<double>& reach_mm) {
  double from = angle(a), to = angle(b);
  if (from > to) std::swap(from, to);
  if (to - from >= std::numbers::pi) return;  // passes behind the apex
  const double last = static_cast<double>(reach_mm.size() - 1);
  const double first_ray = std::max(0.0, std::ceil((from - first_angle) / step));
  for (double k = first_ray; k <= std::min(last, std::floor((to - first_angle) / step)); ++k) {
    const Eigen::Vector2d ray(std::sin(first_angle + k * step), std::cos(first_angle + k * step));
    const double slant = cross(ray, b - a);
    if (slant == 0) continue;  // along the ray: its neighbours meet the same body
    double& reach = reach_mm[static_cast<std::size_t>(k)];
    reach = std::min(reach, std::max(near_mm, cross(a, b - a) / slant) + kShadowSkinMm);
  }
}

bool cross_or_touch(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                    const Eigen::Vector2d& d) {
  const auto side = [](double area) { return area > 0 ? 1 : area < 0 ? -1 : 0; };
  return side(cross(b - a, c - a)) * side(cross(b - a, d - a)) <= 0 &&
         side(cross(d - c, a - c)) * side(cross(d - c, b - c)) <= 0 &&
         Eigen::AlignedBox2d(a.cwiseMin(b), a.cwiseMax(b)).intersects({c.cwiseMin(d), c.cwiseMax(d)});
}

Eigen::AlignedBox2d box_around(std::span<const Eigen::Vector2d> points) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& p : points) box.extend(p);
  return box;
}

/// Points of a line, both ends among them, from which no other is farther than `tolerance_mm`: between two kept ones as
/// many are left out as possible.
std::vector<Eigen::Vector2d> thinned(std::span<const Eigen::Vector2d> line, double tolerance_mm) {
  std::vector<Eigen::Vector2d> kept{line[0]};
  const auto near_chord = [&](const Eigen::Vector2d& p, const Eigen::Vector2d& end) {
    const Eigen::Vector2d chord = end - kept.back();
    const double along = std::clamp((p - kept.back()).dot(chord) / chord.squaredNorm(), 0.0, 1.0);
    return (p - kept.back() - along * chord).norm() <= tolerance_mm;
  };
  std::size_t first = 1;  // of those left out
  for (std::size_t i = 2; i < line.size(); ++i) {
    const auto left_out = line.subspan(first, i - first);
    if (std::all_of(left_out.begin(), left_out.end(), [&](const auto& p) { return near_chord(p, line[i]); })) continue;
    kept.push_back(line[i - 1]);
    first = i;
  }
  kept.push_back(line.back());
  return kept;
}

}  // namespace

Sector covering_sector(const Eigen::AlignedBox3d& bounds_mm, const Trajectory& trajectory) {
  constexpr double kMargin = 0.02;
  constexpr double kWidest = 89 * std::numbers::pi / 180;
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0, widest = 0;
  for (const Eigen::Isometry3d& face : trajectory) {
    for (const Eigen::Vector2d& corner : box_section(bounds_mm, face)) {
      nearest = std::min(nearest, corner.y());  // no point of the section is nearer than its least deep corner is deep
      farthest = std::max(farthest, corner.norm());
      widest = std::max(widest, std::abs(angle(corner)));
    }
  }
  return {(1 - kMargin) * std::clamp(nearest, 0.0, farthest), (1 + kMargin) * farthest,
          std::min(kWidest, (1 + kMargin) * widest)};
}

std::vector<Eigen::Vector2d> field_of_view(const Sector& sector, const PhantomSection& section,
                                           std::span<const Label> shadowing, const Contact& contact) {
  constexpr double kStep = std::numbers::pi / 360;
  constexpr double kThinning = 1.0 / 2000;
  const double parts = std::max(2.0, std::ceil(2 * sector.half_angle_rad / kStep));
  const double step = 2 * sector.half_angle_rad / parts;
  std::vector<double> reach_mm(static_cast<std::size_t>(parts) + 1, sector.far_mm);
  for (const SectionLoop& loop : section.loops) {
    if (loop.hole || std::find(shadowing.begin(), shadowing.end(), loop.label) == shadowing.end()) continue;
    const Eigen::Vector2d* p = &section.points[loop.first];
    for (std::uint32_t i = 0; i < loop.count; ++i)
      cast_shadow(p[i], p[(i + 1) % loop.count], -sector.half_angle_rad, step, sector.near_mm, reach_mm);
  }
  // One beam at least has contact.
  const auto first = static_cast<std::size_t>(std::min(parts - 1, std::ceil(contact.first * parts)));
  const auto last = std::max(first + 1, static_cast<std::size_t>(std::floor(contact.last * parts)));
  std::vector<Eigen::Vector2d> far, near;
  for (std::size_t k = first; k <= last; ++k) {
    const double a = -sector.half_angle_rad + static_cast<double>(k) * step;
    const Eigen::Vector2d beam(std::sin(a), std::cos(a));
    far.push_back(reach_mm[k] * beam);
    near.push_back(sector.near_mm * beam);
  }
  std::reverse(near.begin(), near.end());
  std::vector<Eigen::Vector2d> polygon = thinned(far, kThinning * sector.far_mm);
  if (sector.near_mm == 0)
    polygon.push_back(Eigen::Vector2d::Zero());
  else
    for (const Eigen::Vector2d& p : thinned(near, kThinning * sector.far_mm)) polygon.push_back(p);
  return polygon;
}

bool encloses(std::span<const Eigen::Vector2d> loop, const Eigen::Vector2d& p) {
  bool inside = false;
  for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
    const Eigen::Vector2d &a = loop[j], &b = loop[i];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()))
      inside = !inside;
  }
  return inside;
}

bool overlaps(std::span<const Eigen::Vector2d> loop, std::span<const Eigen::Vector2d> polygon) {
  if (!box_around(loop).intersects(box_around(polygon))) return false;
  if (encloses(polygon, loop[0]) || encloses(loop, polygon[0])) return true;
  for (std::size_t i = 0; i < loop.size(); ++i)
    for (std::size_t j = 0; j < polygon.size(); ++j)
      if (cross_or_touch(loop[i], loop[(i + 1) % loop.size()], polygon[j], polygon[(j + 1) % polygon.size()]))
        return true;
  return false;
}

}  // namespace sonoloft::device_sim
