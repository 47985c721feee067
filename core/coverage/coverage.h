#pragma once
// Beside the stages:  slices, background -> [COVERAGE] -> what is still to be seen, and from where
#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace sonoloft {

class Background;
struct Section;

/// A connected part of the space that no slice came near.
struct CoverageGap {
  double volume_mm3 = 0;
  Eigen::Vector3d centre_mm = Eigen::Vector3d::Zero();  ///< mean of its volume, reference
  double deepest_mm = 0;                                ///< distance of its deepest point to what was seen
  /// A plane for the next slice: of the planes through the gap, that which comes near most of it. x, y in the plane, z
  /// its normal, the origin where the plane is nearest to the gap's centre.
  Eigen::Isometry3d suggested_image_to_reference = Eigen::Isometry3d::Identity();
};

/// How much of the space spanned by the materials that slices showed was really seen. The space: the convex hull of
/// everything labelled as a material (to some degrees of direction, so slightly more). Seen: no farther than two
/// background spacings, 5 mm in a body, from the known part of a slice, whatever it showed there.
struct Coverage {
  double volume_mm3 = 0, seen_mm3 = 0;
  double near_mm = 0;                      ///< up to where a point counts as seen
  std::optional<CoverageGap> largest_gap;  ///< by volume; none when all was seen
  [[nodiscard]] double seen_fraction() const { return volume_mm3 > 0 ? seen_mm3 / volume_mm3 : 1; }
};

/// @param sections    those that the background holds
/// @cost  O(points of all sections * 200 + nodes in the hull + nodes of the gap * 900): some 50 ms for a body.
/// Threads: any, but not while the background changes.
[[nodiscard]] Coverage coverage_of(const std::vector<const Section*>& sections, const Background& background);

}  // namespace sonoloft
