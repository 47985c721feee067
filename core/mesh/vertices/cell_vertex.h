#pragma once
#include <array>
#include <cstdint>

#include "core/mesh/vertices/sample_block.h"

namespace sonoloft {

/// True if the surface around every label is one disc inside the cell, whatever the other labels are: the corners of
/// each label, and all the others, are connected along edges of the cube. Then one vertex serves all of them.
[[nodiscard]] bool is_simple(const CellSamples& cell);

/// Faces of the cell (bit 2 * axis + side) that touch all of its labels, and those that touch more than one.
[[nodiscard]] unsigned faces_with_all_labels(const CellSamples& cell);
[[nodiscard]] unsigned mixed_faces(const CellSamples& cell);

/// The edges along an axis whose ends differ in label: a bit set of their lower ends.
[[nodiscard]] unsigned mixed_edges(const CellSamples& cell, unsigned axis);

/// Where the labels of two corners that differ are equally strong on the line between them: 0 at `lower`, 1 at `upper`,
/// kept 0.01 inside, since no two simplices may share a node; the middle where the samples do not say. Depends on the
/// samples of these two corners alone, so that every cell with this line finds the same bits. Exact beside a slice that
/// the border crosses in a straight line, at whatever angle (docs/pipeline/6-mesh.md).
[[nodiscard]] float crossing(const CellSamples& cell, unsigned lower, unsigned upper);

/// A vertex is moved towards the places where all gaps are zero, at most 2: f_0 - f_k, k = 1..equations, each as a
/// function that is linear near slices too.
inline constexpr int kMaxEquations = 2;
using Gaps = std::array<std::array<float, 8>, kMaxEquations>;  ///< [equation][corner]

/// The equations of a simple cell: labels - 1 of them, or none if that is too many (the vertex then stays in the mean
/// of its crossings).
[[nodiscard]] int gaps_of(const CellSamples& cell, Gaps& gaps);

/// The same of a cell whose gaps are known.
[[nodiscard]] float crossing(const CellSamples& cell, const Gaps& gaps, unsigned lower, unsigned upper);

/// A position in lattice steps from the cell's lowest corner, and back: it is then kept 0.03 inside of the cell.
[[nodiscard]] Eigen::Vector3f to_steps(const CellPoint& point);
[[nodiscard]] CellPoint to_cell_point(const Eigen::Vector3f& steps);

/// Mean of the crossings on the edges, then one Newton step.
[[nodiscard]] CellPoint place_vertex(const CellSamples& cell, const Gaps& gaps, int equations);

/// Moves 0.85 of the way to `mean` (relative to the cell, in lattice steps), then one Newton step.
[[nodiscard]] CellPoint relax_vertex(const CellPoint& vertex, const Eigen::Vector3f& mean, const float* gaps,
                                     int equations);

/// The direction in which the first gap grows at a vertex, of length 1; 0 where it grows nowhere.
[[nodiscard]] Eigen::Vector3f normal_at(const CellPoint& vertex, const float* gaps);

}  // namespace sonoloft
