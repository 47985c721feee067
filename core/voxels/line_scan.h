#pragma once
// Where lines meet a mesh:  mesh -> [LINE SCAN] -> crossings of one row of lines after the other
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/slice/result.h"

namespace sonoloft {

/// Equally spaced values  start + index * step.  One definition of "the first index at or above a value" for every
/// caller is what makes lines through vertices count once.
struct Ticks {
  double start;
  double step;
  std::size_t count;
  [[nodiscard]] double at(std::size_t index) const { return start + static_cast<double>(index) * step; }
  /// Smallest index whose tick is not below `value`, or count.
  [[nodiscard]] std::size_t first_not_below(double value) const;
};

/// The box of the vertices that triangles use. @param what  the mesh's name in messages
/// @error empty_input (no triangle), non_finite
[[nodiscard]] Result<Eigen::AlignedBox3d> used_box(const IndexedMesh& mesh, const char* what);

/// The lines parallel to x through every (y, z) of a grid; a row are those of one z. By one rule for all triangles, a
/// line through a vertex or an edge crosses a closed mesh there once or not at all, so that every label's border is met
/// an even number of times. Frame: the mesh's, mm. Threads: crossings() from any.
class LineScan {
 public:
  /// Line j of row k, at ticks y and z, goes through triangle t at x.
  using Visit = std::function<void(std::uint32_t j, double x, std::size_t t)>;

  /// @pre  the mesh outlives the scan, its indices are in range, its positions finite
  /// @cost O(#T + rows that triangles reach)
  LineScan(const IndexedMesh& mesh, const Ticks& y, const Ticks& z);

  /// In no order that means anything, but always the same. @cost O(triangles that reach the row + crossings)
  void crossings(std::size_t row, const Visit& visit) const;

 private:
  void cross(std::size_t triangle, double z, const Visit& visit) const;

  const IndexedMesh& mesh_;
  Ticks y_, z_;
  std::vector<std::size_t> first_;  ///< triangles that reach row k: triangle_[first_[k]] .. [first_[k + 1]]
  std::vector<std::uint32_t> triangle_;
};

}  // namespace sonoloft
