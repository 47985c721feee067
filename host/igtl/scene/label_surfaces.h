#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/slice/label.h"

// MeshSnapshot -> [LABEL SURFACES] -> one message a label

namespace sonoloft::igtl {

/// The closed boundary of one label, in RAS: x and y of the reference frame, which is LPS, turned round; normals
/// (counter-clockwise) point out of the label.
struct LabelSurface {
  Label label;
  std::vector<std::array<float, 3>> points;             ///< [#V] mm; each is used
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< [#T] indices into points
};

/// The surfaces of all labels of a mesh but outside, ascending by label. A wall between two labels is part of both.
/// @cost O(#V + #T)
[[nodiscard]] std::vector<LabelSurface> label_surfaces(const IndexedMesh& mesh);

}  // namespace sonoloft::igtl
