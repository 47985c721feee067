#pragma once
// Meshes in and out of files:  core/mesh -> [IO] -> file
#include <filesystem>
#include <span>

#include "core/io/labels/label_table.h"
#include "core/mesh/mesh.h"
#include "core/slice/result.h"

namespace sonoloft {

// Every writer: coordinates are written as they are, mm, and tagged SPACE=LPS; the file is replaced.
// @pre   mesh.label_front.size() == mesh.label_back.size() == mesh.triangles.size(), indices in range
// @error io_failed: the file is incomplete
// @cost  O(bytes), one buffer of the size of the file

/// What a PLY file can say of every vertex besides; empty or [#V].
struct VertexProperties {
  std::span<const float> measured, distance_mm;
};

// Those that take `labels` write what the mesh's labels are called and how they look. A triangle has the colour of the
// label behind it, or of the one in front where outside is behind.

/// Binary little-endian PLY: a comment `label 7 205 98 80 liver` for every label; vertex float x y z, and float
/// measured distance_mm where given; face list uchar int vertex_indices, ushort label_front label_back, uchar red green
/// blue.
[[nodiscard]] Result<void> write_ply(const IndexedMesh& mesh, const std::filesystem::path& path,
                                     const LabelTable& labels = {}, const VertexProperties& properties = {});

/// Wavefront OBJ, one group `front_F_back_B` for each pair of labels, with all digits of the floats; its first
/// position stands there twice. Beside it, with the ending .mtl, a material for every label, by its name with `_` for
/// blanks.
[[nodiscard]] Result<void> write_obj(const IndexedMesh& mesh, const std::filesystem::path& path,
                                     const LabelTable& labels = {});

/// Binary STL; the format has no labels.
[[nodiscard]] Result<void> write_stl(const IndexedMesh& mesh, const std::filesystem::path& path);

/// VTK XML PolyData, appended base64. Cell data `BoundaryLabels`, 2 components as vtkSurfaceNets3D has them: the normal
/// points from the first to the second and outside is never the first (such triangles are turned around). Field data
/// `LabelValues`, `LabelNames` and `LabelColors` (red, green, blue), a tuple for every label.
[[nodiscard]] Result<void> write_vtp(const IndexedMesh& mesh, const std::filesystem::path& path,
                                     const LabelTable& labels = {});

/// Reads a mesh by the file's ending: .ply (ascii, binary of either byte order), .stl (ascii, binary), .obj, .off.
/// Polygons are cut into fans, triangles that use a vertex twice are dropped, equal positions of an STL are joined,
/// positions of no triangle are left out.
/// Labels are those that write_ply and write_obj wrote, else front 0, back 1.
/// @error file_not_found, io_failed, unsupported_format, parse_failed (with the line in text), non_finite, too_large
/// @cost  O(bytes); allocates nothing on the word of a declared count
[[nodiscard]] Result<IndexedMesh> read_mesh(const std::filesystem::path& path);

}  // namespace sonoloft
