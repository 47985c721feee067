#pragma once
// What CSL and .contour have in common: planes and vertices in space -> TrackedSlice.
#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "core/io/slices/slice_files.h"

namespace sonoloft {

/// A plane as a file states it; `placed` is what place_planes() makes of it.
struct FilePlane {
  std::size_t line;        ///< where the plane begins
  Eigen::Vector3d normal;  ///< of any length
  double offset;           ///< normal . x + offset = 0, or = 2 offset where the file means the other sign
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::uint32_t> view;  ///< the vertices of its field of view; empty: all of the plane was seen

  Eigen::Isometry3d image_to_reference = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Vector2d> image;  ///< [#vertices] projected, image frame
};

/// A closed loop through vertices of a plane.
struct FileLoop {
  std::vector<std::uint32_t> vertices;
  Label label;
  bool hole;
};

/// Tells the sign of each plane's offset from its vertices, projects them and chooses image frames.
/// @error non_finite, non_planar, parse_failed (a normal of zero), bad_contour (beyond kMaxCoordinate_mm)
[[nodiscard]] Result<void> place_planes(std::vector<FilePlane>& planes, const std::string& name, SliceFileNotes& notes);

/// Builds the slices, one for each plane in space; planes with a field of view are slices of their own.
/// @pre   loops.size() == planes.size(), vertices of loops and views in range
/// @error empty_input (no loop at all), too_large
[[nodiscard]] Result<SliceFile> build_slices(const std::vector<FilePlane>& planes,
                                             const std::vector<std::vector<FileLoop>>& loops, const std::string& name,
                                             SliceFileNotes notes);

}  // namespace sonoloft
