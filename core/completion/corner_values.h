#pragma once
// cells of a group -> [CORNERS] -> shares of the labels at corners in unknown parts of a plane
#include <span>
#include <vector>

#include "core/cells/cell_complex.h"
#include "core/completion/plane_regions.h"
#include "core/slice/label.h"

namespace sonoloft {

/// A wall as its cell sees it, and the cell on its other side (behind its middle); of a wall of the box kNoCellBehind.
struct SeenWall {
  CellFace face;
  CellId behind;
};
inline constexpr CellId kNoCellBehind{0xFFFFFFFF};

/// What a group of cells knows, for the corners of its unknown parts. The share of label l at corner v of plane P is
///
///             sum_F integral_{F, l} |h| / |y - v|^4 dA  +  lambda sum_e integral_{e, l} |d phi| / |y - v|
///   f_l(v) =  -------------------------------------------------------------------------------------------
///                          the same for all labels together
///
/// F: the known parts of the group's walls that do not lie in P, each wall once; h the height of v over its plane.
/// e: in P, the borders between what is known and what is not of the group's walls; phi the angle around v.
/// lambda = 2: the first integral is over a sphere of directions (4 pi), the second over a circle (2 pi); it has no
/// unit, since both are 1/length. Where a group knows nothing: outside.
/// Source: Bermano, Vaxman, Gotsman 2011, section 5, equation 7.
class GroupKnowledge {
 public:
  /// @param walls   [cell] of all cells
  /// @param group   ascending
  /// @param labels  [#L] ascending, all labels of the walls among them
  GroupKnowledge(const std::vector<std::vector<SeenWall>>& walls, std::span<const CellId> group,
                 std::span<const Label> labels, double min_height_mm);

  /// @param corners_mm  of one plane, up to kPointLanes
  /// @param shares      out, [#L]
  void shares(PlaneId plane, std::span<const Eigen::Vector3d> corners_mm, std::span<PointLanes> shares) const;

 private:
  struct Rim {
    Eigen::Vector2d a, b;
    std::uint32_t slot;
  };
  struct KnownPlane {
    PlaneId plane;
    PlaneRegions regions;
    Eigen::Isometry3d reference_to_image;
    std::vector<Rim> rims;
  };
  void add(const SeenWall& wall, bool twice_seen, std::span<const Label> labels, double min_height_mm);

  std::vector<KnownPlane> planes_;  ///< ascending
};

}  // namespace sonoloft
