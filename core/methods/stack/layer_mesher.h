#pragma once
// a method's field, layer by layer -> [LAYER MESHER] -> one mesh, drawn as the live one is
#include <span>

#include "core/mesh/mesh.h"
#include "core/methods/stack/layered_field.h"
#include "core/slice/result.h"
#include "core/slice/section.h"

namespace sonoloft {

/// Whether a box with so many slices can be sampled at a spacing. Ask before a field is made.
/// @error too_large (over 2^17 samples in a row, 2^30 of them or of nodes of all slices)
[[nodiscard]] Result<void> check_size(const Eigen::Vector3d& sizes_mm, double spacing_mm, std::size_t slices);

/// Samples a field on the lattice of its grid's nodes, in cubes, and draws the surfaces between its labels with
/// SurfaceExtractor, on the contours of the slices where those run. Whatever the field says at its outermost nodes is
/// cut off there: keep a margin. Frame: the field's, mm.
/// @param slices  image_to_reference leads to the field's frame
/// @post  closed, manifold around every label, without crossings (docs/pipeline/6-mesh.md); does not depend on
/// `threads`
/// @error empty_input (nothing as large as a cell)
/// @cost  O(#labels * #samples); holds ten layers and the bricks with a surface
[[nodiscard]] Result<IndexedMesh> mesh_of(const LayeredField& field, std::span<const Section> slices, int threads);

/// The mesh in another frame.
[[nodiscard]] IndexedMesh moved(IndexedMesh mesh, const Eigen::Isometry3d& to);

}  // namespace sonoloft
