#pragma once
#include <deque>
#include <vector>

#include "core/methods/straight_skeleton/exact/polygon.h"
#include "core/methods/straight_skeleton/patch/convex_pieces.h"

namespace sonoloft::skeleton {

/// An upright border between two labels: over a piece of a contour, or over its continuation beyond a rim.
struct Curve {
  FormPtr line;
  std::vector<FormPtr> ends;  ///< positive within
  Label positive, negative;   ///< of both sides of the line
};

/// A convex part of a slice's plane, the whole of it among them, in which the way down to the patch is linear: within
/// the patch, beyond a rim or beyond a corner of rims.
struct Footing {
  Polygon outline;                       ///< in the plane, all sides upright
  FormPtr beyond;                        ///< distance from the patch, seen from above
  const PatchMap* map{};                 ///< of the patch where the footing lies within it
  PatchMap::Run run{};                   ///< else: of the rim's labels
  std::array<Eigen::Vector3d, 2> rim{};  ///< and its ends
  std::vector<Curve> curves{};

  /// The label of a point over it; where that lies on a curve, of the side that `towards` points to.
  [[nodiscard]] Label label_at(const Corner& p, const Eigen::Vector3d& towards, double doubt_mm) const;
};

/// A convex part of space over a footing in which the distance from the patches of a plane is linear.
struct FrontCell {
  std::uint32_t footing;
  FormPtr distance;
  std::vector<FormPtr> facets;  ///< positive within
  std::vector<FormPtr> off;     ///< where these are positive there is no patch of the plane
};

/// All patches of one plane, and how their fronts go through space: up and down from the patch, and sideways from its
/// rims, in planes orthogonal to it.
struct Front {
  std::deque<PatchMap> maps;
  std::vector<Footing> footings;
  std::vector<FrontCell> cells;
};

/// @param universe  a box that every foot of a point lies in
/// @return whether there are few enough: patches with many bends inwards make too many
[[nodiscard]] bool find_footings(Front& front, const ExactBox& universe, double reach_mm);

/// A wall of the box, from which the outside comes in.
[[nodiscard]] Front front_of_wall(const FormPtr& wall);

}  // namespace sonoloft::skeleton
