#pragma once
// mesh, the slices it was made of, what these were cut from -> [ACCURACY] -> the figures of docs/accuracy.md
#include <Eigen/Geometry>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/slice/result.h"
#include "core/slice/tracked_slice.h"
#include "host/apps/measure/agreement.h"
#include "host/apps/measure/measure.h"
#include "host/apps/measure/pieces.h"
#include "host/apps/measure/slice_normals.h"

namespace sonoloft {

/// What the slices were cut from. Frame: reference, mm.
struct TrueBody {
  const IndexedMesh& surface;
  std::function<Label(const Eigen::Vector3d&)> label_at{};  ///< called from several threads; empty: the surface tells
};

struct Accuracy {
  double diagonal_mm;   ///< of the box of the truth's surface
  Agreement agreement;  ///< in that box, widened by 2 % of its diagonal on every side
  SurfaceDistance distance;
  Pieces pieces, truth_pieces;  ///< large: at least 1e-5 of the widened box
  SlicePassage passage;         ///< in bands of 1 % of the diagonal
};

/// @pre   threads >= 1, indices of the mesh in range; the result does not depend on `threads`
/// @error of the truth: empty_input, non_finite, invalid_argument (it is turned inside out)
/// @cost  about a second for 300,000 triangles
[[nodiscard]] Result<Accuracy> measure_accuracy(const IndexedMesh& mesh, std::span<const TrackedSlice> slices,
                                                const TrueBody& truth, int threads);

/// The same by name, with the mean IoU over the labels, and distances in % of the diagonal: what reports call them.
[[nodiscard]] std::vector<std::pair<std::string, double>> figures_of(const Accuracy& accuracy);

}  // namespace sonoloft
