#include "core/slice/section.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "core/slice/planar/label_sweep.h"
#include "core/slice/planar/planar_network.h"

namespace sonoloft {
namespace {

using Eigen::Vector2d;

Result<void> check_pose(const Eigen::Isometry3d& pose) {
  if (!pose.matrix().allFinite()) return fail(ErrorCode::non_finite, "the slice's pose is not finite: drop the slice");
  const Eigen::Matrix3d r = pose.linear();
  const double error = (r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (error > kRigidTolerance || r.determinant() < 0)
    return fail(ErrorCode::not_rigid, "the slice's pose is not a rotation: put scale into the points, mm");
  if (pose.translation().cwiseAbs().maxCoeff() > kMaxCoordinate_mm)
    return fail(ErrorCode::bad_contour, "the slice is more than 1e9 mm away: check the units, mm are expected");
  return {};
}

Result<void> check_loop(std::span<const Vector2d> loop, const std::string& what) {
  if (loop.size() < 3) return fail(ErrorCode::bad_contour, what + " has fewer than 3 points: leave it out");
  for (const Vector2d& p : loop) {
    if (!p.allFinite()) return fail(ErrorCode::non_finite, what + " has a point that is not finite: drop the slice");
    if (p.cwiseAbs().maxCoeff() > kMaxCoordinate_mm)
      return fail(ErrorCode::bad_contour, what + " has a point beyond 1e9 mm: check the units, mm are expected");
  }
  return {};
}

Result<void> check_contours(const TrackedSlice& slice) {
  if (slice.contours.size() > kMaxSliceContours)
    return fail(ErrorCode::too_large, "the slice has " + std::to_string(slice.contours.size()) + " contours, at most " +
                                          std::to_string(kMaxSliceContours) + " are allowed: leave out specks");
  std::uint64_t total = slice.field_of_view.size();
  for (std::size_t i = 0; i < slice.contours.size(); ++i) {
    const Contour& c = slice.contours[i];
    const std::string what = "contour " + std::to_string(i);
    if (c.first > slice.points.size() || c.count > slice.points.size() - c.first)
      return fail(ErrorCode::bad_contour, what + " names points that the slice does not have: mend the sender");
    if (c.label > kMaxLabel && c.label != kUnknown && !c.hole)
      return fail(ErrorCode::bad_contour, what + " has the reserved label " + std::to_string(c.label) + ": use 0 to " +
                                              std::to_string(kMaxLabel) + ", or unknown");
    total += c.count;
    if (total > kMaxSlicePoints) break;
    if (auto ok = check_loop(std::span(slice.points).subspan(c.first, c.count), what); !ok) return ok;
  }
  if (total > kMaxSlicePoints)
    return fail(ErrorCode::too_large,
                "the slice has more than " + std::to_string(kMaxSlicePoints) + " points: thin out its contours");
  if (!slice.field_of_view.empty()) return check_loop(slice.field_of_view, "the field of view");
  return {};
}

/// Visits the loops with their number: contours 0..#C-1, then the field of view.
void for_each_loop(const TrackedSlice& slice, const auto& visit) {
  std::uint32_t owner = 0;
  for (const Contour& c : slice.contours) visit(std::span(slice.points).subspan(c.first, c.count), owner++);
  if (!slice.field_of_view.empty()) visit(std::span(slice.field_of_view), owner);
}

/// Steps are powers of 2 and the origin a multiple of the step: grid points are exact in double.
struct Grid {
  Vector2d origin = Vector2d::Zero();
  double step = 1;

  explicit Grid(const TrackedSlice& slice) {
    Eigen::AlignedBox2d box;
    for_each_loop(slice, [&](std::span<const Vector2d> loop, std::uint32_t) {
      for (const Vector2d& p : loop) box.extend(p);
    });
    if (box.isEmpty()) return;
    const double extent = box.sizes().maxCoeff();
    const double farthest = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
    const auto power_above = [](double v) { return std::ilogb(std::max(v, std::numeric_limits<double>::min())) + 1; };
    // Finer than the coordinates' own last bit means nothing; finer than 2^-500 mm overflows.
    step = std::ldexp(1.0, std::max({power_above(extent) - 30, power_above(farthest) - 53, -500}));
    origin = (box.min() / step).array().floor() * step;
  }

  GridPoint snap(const Vector2d& p) const {
    const Vector2d cell = ((p - origin) / step).array().round();
    return {static_cast<std::int32_t>(cell.x()), static_cast<std::int32_t>(cell.y())};
  }
  Vector2d position(GridPoint p) const { return origin + step * Vector2d(p.x, p.y); }
};

std::vector<OwnedSegment> snapped_segments(const TrackedSlice& slice, const Grid& grid) {
  std::vector<OwnedSegment> segments;
  segments.reserve(slice.points.size() + slice.field_of_view.size());
  for_each_loop(slice, [&](std::span<const Vector2d> loop, std::uint32_t owner) {
    GridPoint from = grid.snap(loop.back());
    for (const Vector2d& p : loop) {
      const GridPoint to = grid.snap(p);
      if (from < to) segments.push_back({from, to, owner});
      if (to < from) segments.push_back({to, from, owner});
      from = to;
    }
  });
  cancel_pairs(segments);
  return segments;
}

/// Keeps the edges between different labels and the points that they use.
void fill(Section& section, const LabelledNetwork& network, const Grid& grid) {
  constexpr std::uint32_t kUnused = 0xFFFFFFFF;
  std::vector<std::uint32_t> place(network.points.size(), kUnused);
  const auto is_border = [](const LabelledEdge& e) { return e.above != e.below; };
  for (const LabelledEdge& e : network.edges)
    if (is_border(e)) place[e.a] = place[e.b] = 0;
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] == kUnused) continue;
    place[i] = static_cast<std::uint32_t>(section.points.size());
    section.points.push_back(grid.position(network.points[i]));
  }
  for (const LabelledEdge& e : network.edges)
    if (is_border(e)) section.edges.push_back({place[e.a], place[e.b], e.above, e.below});
}

}  // namespace

Result<Section> make_section(const TrackedSlice& slice) {
  if (auto ok = check_pose(slice.image_to_reference); !ok) return tl::unexpected(ok.error());
  if (auto ok = check_contours(slice); !ok) return tl::unexpected(ok.error());

  const Grid grid(slice);
  std::vector<OwnedSegment> segments = snapped_segments(slice, grid);
  const auto split = split_at_crossings(segments, static_cast<std::uint32_t>(slice.contours.size()));
  if (split.too_tangled)
    return fail(ErrorCode::too_large,
                "the slice's contours are a tangle of long strokes, no outlines of regions: drop it");

  std::vector<Enclosure> enclosures;
  enclosures.reserve(slice.contours.size());
  for (const Contour& c : slice.contours) enclosures.push_back({c.hole ? kOutside : c.label, c.hole});
  const bool has_view = !slice.field_of_view.empty();

  Section section;
  section.image_to_reference = slice.image_to_reference;
  section.border = has_view ? kUnknown : kOutside;
  section.repaired_crossings = split.crossings;
  fill(section, label_sweep(segments, enclosures, has_view), grid);
  return section;
}

Label label_at(const Section& section, const Vector2d& point_mm) {
  Label label = section.border;
  double nearest = -std::numeric_limits<double>::infinity();
  for (const SectionEdge& e : section.edges) {  // the first edge below the point
    const Vector2d &a = section.points[e.a], &b = section.points[e.b];
    if (!(a.x() <= point_mm.x() && point_mm.x() < b.x())) continue;
    const double y = a.y() + (b.y() - a.y()) * ((point_mm.x() - a.x()) / (b.x() - a.x()));
    if (y > point_mm.y() || y < nearest) continue;  // of edges from one point, the last is the uppermost
    nearest = y;
    label = e.left;
  }
  return label;
}

}  // namespace sonoloft
