#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/cells/cell_complex.h"
#include "core/field/packing/bent_face.h"
#include "core/slice/label.h"

namespace sonoloft {

/// What a label has of a point, and of all labels together what there is to have.
struct ReferenceShares {
  struct Entry {
    Label label;
    double share;
  };
  std::vector<Entry> shares;  ///< ascending by label, every label of the cell's walls; kUnknown not yet filled in
  double total_per_mm = 0;    ///< T = sum over the faces of the integral of h / |y - x|^4 dA, 1/mm
  [[nodiscard]] double share(Label label) const;  ///< 0 for a label that the cell does not have
};

/// The field at one point in double precision, straight from the faces, one arc tangent per edge: what the kernels are
/// measured against. Points nearer to a wall than `min_height_mm` are held that far off it.
/// @param bends  [faces] how contours move with the height over their face; empty: none moves
/// Frame: reference, mm. @pre the cell has edges; min_height_mm > 0
/// @cost O(#edges), slow. Threads: any.
[[nodiscard]] ReferenceShares reference_shares(std::span<const CellFace> faces, const Eigen::Vector3d& point_mm,
                                               double min_height_mm, std::span<const FaceBends> bends = {});

}  // namespace sonoloft
