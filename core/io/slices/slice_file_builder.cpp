#include "core/io/slices/slice_file_builder.h"

#include <algorithm>
#include <cmath>

#include "core/slice/section.h"

namespace sonoloft {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Shares of the diagonal of all vertices.
constexpr double kMovedTolerance = 1e-6;
constexpr double kSamePlaneTolerance = 1e-9;

std::string at_line(const std::string& name, std::size_t line) {
  return name + ":" + std::to_string(line) + ": ";
}

/// The farthest vertex from the plane with that offset; the normal is of unit length.
double off_plane(const FilePlane& plane, double offset) {
  double farthest = 0;
  for (const Vector3d& v : plane.vertices) farthest = std::max(farthest, std::abs(plane.normal.dot(v) + offset));
  return farthest;
}

Result<void> check_numbers(const FilePlane& plane, const std::string& name) {
  for (const Vector3d& v : plane.vertices)
    if (v.cwiseAbs().maxCoeff() > kMaxCoordinate_mm)
      return fail(ErrorCode::bad_contour,
                  at_line(name, plane.line) + "a vertex of the plane is beyond 1e9 mm: check the units");
  if (!(plane.normal.stableNorm() > 1e-150) || plane.normal.stableNorm() > 1e150)
    return fail(ErrorCode::parse_failed,
                at_line(name, plane.line) + "the plane's normal is zero or absurd: give it a direction");
  return {};
}

Result<void> normalise(FilePlane& plane, const std::string& name, SliceFileNotes& notes) {
  if (auto ok = check_numbers(plane, name); !ok) return ok;
  const double length = plane.normal.stableNorm();
  notes.scaled_normals += std::abs(length - 1) > 1e-6;
  plane.normal /= length;
  plane.offset /= length;
  if (std::abs(plane.offset) > kMaxCoordinate_mm)
    return fail(ErrorCode::bad_contour, at_line(name, plane.line) + "the plane is beyond 1e9 mm: check the units");
  return {};
}

/// A rigid frame with z along the normal; the image's x is the axis of space that is nearest to the plane.
Eigen::Isometry3d frame(const Vector3d& normal, const Vector3d& origin) {
  Eigen::Index flattest;
  normal.cwiseAbs().minCoeff(&flattest);
  const Vector3d x = (Vector3d::Unit(flattest) - normal[flattest] * normal).normalized();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear().col(0) = x;
  pose.linear().col(1) = normal.cross(x);
  pose.linear().col(2) = normal;
  pose.translation() = origin;
  return pose;
}

void place(FilePlane& plane, const Vector3d& middle_of_all) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& v : plane.vertices) box.extend(v);
  const Vector3d middle = box.isEmpty() ? middle_of_all : box.center();
  plane.image_to_reference = frame(plane.normal, middle - (plane.normal.dot(middle) + plane.offset) * plane.normal);
  const Eigen::Isometry3d reference_to_image = plane.image_to_reference.inverse();
  plane.image.reserve(plane.vertices.size());
  for (const Vector3d& v : plane.vertices) plane.image.push_back((reference_to_image * v).head<2>());
}

/// Flips the offsets of the planes whose vertices say so, and those of planes without vertices as the others are.
void flip_offsets(std::vector<FilePlane>& planes, SliceFileNotes& notes) {
  std::vector<std::size_t> silent;
  std::size_t stated = 0, flipped = 0;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const double as_is = off_plane(planes[i], planes[i].offset), turned = off_plane(planes[i], -planes[i].offset);
    if (as_is == turned)
      silent.push_back(i);
    else if (turned < as_is)
      ++flipped, planes[i].offset = -planes[i].offset;
    else
      ++stated;
  }
  if (flipped > stated)
    for (const std::size_t i : silent) planes[i].offset = -planes[i].offset;
  notes.flipped_offsets = static_cast<std::uint32_t>(flipped);
}

/// Views are not joined: where one of two images saw nothing, the other may have.
bool same_plane(const FilePlane& p, const FilePlane& q, double diagonal) {
  if (!p.view.empty() || !q.view.empty()) return false;
  const double side = p.normal.dot(q.normal) < 0 ? -1 : 1;
  return (p.normal - side * q.normal).norm() <= kSamePlaneTolerance &&
         std::abs(p.offset - side * q.offset) <= kSamePlaneTolerance * diagonal;
}

Eigen::AlignedBox3d box_of(const std::vector<FilePlane>& planes) {
  Eigen::AlignedBox3d box(Vector3d::Zero().eval());
  if (std::any_of(planes.begin(), planes.end(), [](const FilePlane& p) { return !p.vertices.empty(); })) box.setEmpty();
  for (const FilePlane& plane : planes)
    for (const Vector3d& v : plane.vertices) box.extend(v);
  return box;
}

/// Adds the loops of a plane to a slice that lies in it.
void add_loops(TrackedSlice& slice, const FilePlane& plane, const std::vector<FileLoop>& loops) {
  const Eigen::Isometry3d to_image = slice.image_to_reference.inverse() * plane.image_to_reference;
  for (const FileLoop& loop : loops) {
    slice.contours.push_back({static_cast<std::uint32_t>(slice.points.size()),
                              static_cast<std::uint32_t>(loop.vertices.size()), loop.label, loop.hole});
    for (const std::uint32_t v : loop.vertices) {
      const Vector2d& p = plane.image[v];
      slice.points.push_back((to_image * Vector3d(p.x(), p.y(), 0)).head<2>());
    }
  }
}

}  // namespace

Result<void> place_planes(std::vector<FilePlane>& planes, const std::string& name, SliceFileNotes& notes) {
  for (FilePlane& plane : planes)
    if (auto ok = normalise(plane, name, notes); !ok) return ok;
  flip_offsets(planes, notes);
  const Eigen::AlignedBox3d box = box_of(planes);
  const double diagonal = box.diagonal().norm();
  for (FilePlane& plane : planes) {
    const double farthest = off_plane(plane, plane.offset);
    if (farthest > kPlanarTolerance * diagonal)
      return fail(ErrorCode::non_planar,
                  at_line(name, plane.line) + "a vertex is " + std::to_string(farthest) +
                      " mm off its plane, over 1 % of the whole: mend the plane or its vertices");
    notes.largest_offset_mm = std::max(notes.largest_offset_mm, farthest);
    for (const Vector3d& v : plane.vertices)
      notes.moved_vertices += std::abs(plane.normal.dot(v) + plane.offset) > kMovedTolerance * diagonal;
    place(plane, box.center());
  }
  return {};
}

Result<SliceFile> build_slices(const std::vector<FilePlane>& planes, const std::vector<std::vector<FileLoop>>& loops,
                               const std::string& name, SliceFileNotes notes) {
  const double diagonal = box_of(planes).diagonal().norm();
  SliceFile file{{}, notes};
  std::vector<std::size_t> first_plane;  // [slice] the plane that it was made from
  bool any_loop = false;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const auto earlier = std::find_if(first_plane.begin(), first_plane.end(),
                                      [&](std::size_t k) { return same_plane(planes[k], planes[i], diagonal); });
    const auto k = static_cast<std::size_t>(earlier - first_plane.begin());
    if (earlier == first_plane.end()) {
      first_plane.push_back(i);
      file.slices.emplace_back().id = k;
      file.slices[k].image_to_reference = planes[i].image_to_reference;
    } else {
      ++file.notes.merged_planes;
    }
    add_loops(file.slices[k], planes[i], loops[i]);
    for (const std::uint32_t v : planes[i].view) file.slices[k].field_of_view.push_back(planes[i].image[v]);
    any_loop |= !loops[i].empty();
    if (file.slices[k].points.size() + planes[i].view.size() > kMaxSlicePoints ||
        file.slices[k].contours.size() > kMaxSliceContours)
      return fail(ErrorCode::too_large, at_line(name, planes[i].line) +
                                            "over 2^20 points or 2^14 contours in one plane: thin out its contours");
  }
  if (!any_loop) return fail(ErrorCode::empty_input, name + ": no plane has a contour: nothing to reconstruct");
  return file;
}

}  // namespace sonoloft
