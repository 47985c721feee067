#pragma once
#include <array>
#include <set>
#include <string>
#include <vector>

#include "core/mesh/mesh.h"

namespace sonoloft::test {

/// A triangle's corners in the digits that clients print, the smallest first, in their order.
using PrintedTriangle = std::array<std::string, 3>;

/// A POLYDATA as PolyDataClient prints it.
struct PrintedSurface {
  std::size_t points = 0;
  std::multiset<PrintedTriangle> triangles;
  std::set<std::string> labels;  ///< of its points
  std::size_t labelled = 0;      ///< points
};
[[nodiscard]] std::vector<PrintedSurface> surfaces_in(const std::string& printed);

/// What is to be printed for a label of a mesh: its triangles in RAS, their normals outwards.
[[nodiscard]] PrintedSurface expected(const IndexedMesh& mesh, Label label);

/// The matrices that ReceiveClient prints for TRANSFORM.
[[nodiscard]] std::vector<Eigen::Matrix4d> matrices_in(const std::string& printed);

}  // namespace sonoloft::test
