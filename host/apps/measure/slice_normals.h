#pragma once
// A mesh near its slices -> [SLICE NORMALS] -> does the surface pass through them without a crease?
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <map>
#include <span>
#include <tuple>

#include "core/mesh/mesh.h"
#include "core/slice/tracked_slice.h"

namespace sonoloft {

/// A stretch of a contour, one band long: which slice, which stretch of it, which two labels the surface parts there.
/// Stretches that follow each other on a contour have numbers that do.
using ContourPlace = std::tuple<std::size_t, std::size_t, Label, Label>;

/// The area of a surface within one band below [0] and above [1] a slice, times its normal, which points to the smaller
/// label. Triangles count part by part, a third of a band each, for the stretch that is nearest in the slice's plane,
/// within one band. Only places with surface on both sides are here.
using SliceNormals = std::map<ContourPlace, std::array<Eigen::Vector3d, 2>>;

/// Stretches that lie within two bands of another slice's plane are left out: there the surface must turn.
/// @pre   indices in range, band_mm > 0
/// @cost  O(#T #slices)
[[nodiscard]] SliceNormals normals_at_slices(const IndexedMesh& mesh, std::span<const TrackedSlice> slices,
                                             double band_mm);

/// How two surfaces pass through the slices; means over the places that both have, degrees; all 0 where there is none.
struct SlicePassage {
  double turn_deg = 0;        ///< angle between the normals below and above; curvature c alone gives c * band_mm
  double truth_turn_deg = 0;  ///< the same of the truth
  double crease_deg = 0;  ///< length of the difference of both turns: that of the unit normals above less those below
  double lean_deg = 0;    ///< angle between the mesh's and the truth's normal, both sides together
  std::array<double, 3> turn_quartiles_deg{};  ///< of what turn_deg is the mean of
  /// Angle between the normals of stretches that follow each other, both sides together: how far the surface turns over
  /// as long a way along the slice. Of all places, whether the other has them or not.
  double along_deg = 0, truth_along_deg = 0;
};
[[nodiscard]] SlicePassage compare_passage(const SliceNormals& mesh, const SliceNormals& truth);

}  // namespace sonoloft
