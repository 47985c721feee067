#pragma once
// Recorded slices:  file <-> [IO] <-> TrackedSlice -> make_section -> cells
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/slice/result.h"
#include "core/slice/tracked_slice.h"

namespace sonoloft {

/// What was repaired while a file of slices was read: all zero for a file that keeps its format's rules.
struct SliceFileNotes {
  std::uint32_t scaled_normals = 0;      ///< planes whose normal was not of unit length (beyond 1e-6)
  std::uint32_t flipped_offsets = 0;     ///< planes whose constant had the wrong sign for their vertices
  std::uint32_t flipped_sides = 0;       ///< planes of a .contour file with left and right exchanged
  std::uint32_t merged_planes = 0;       ///< planes that lay in an earlier one and were joined with it
  std::uint32_t moved_vertices = 0;      ///< vertices farther than 1e-6 of the diagonal off their plane, projected
  double largest_offset_mm = 0;          ///< the farthest that any vertex lay off its plane
  std::uint32_t dropped_components = 0;  ///< components of fewer than 3 vertices, which enclose nothing
  bool trailing_text = false;            ///< text after the last declared plane was not read
};

struct SliceFile {
  std::vector<TrackedSlice> slices;  ///< in the file's order; slice.id = index; planes without a contour are kept
  SliceFileNotes notes;
};

/// Limits on a file of slices; more is an error. Those of one slice are in core/slice/section.h.
inline constexpr std::uint32_t kMaxFileSlices = 1u << 14;
/// Vertices farther off their plane than this share of the diagonal of all vertices are an error.
inline constexpr double kPlanarTolerance = 1e-2;

/// Reads a CSL file: planes Ax+By+Cz+D=0, vertices, closed components with a label, holes; and, behind the last plane,
/// fields of view and unknown regions (docs/csl.md).
/// Coordinates are taken as mm, reference frame. The image frame of a slice has its z along the file's normal and its
/// origin in the middle of the slice's vertices (of a slice without any: below the middle of all vertices).
/// @post  every slice has points.size() <= kMaxSlicePoints, contours of at least 3 points, a rigid pose
/// @error file_not_found, io_failed, unsupported_format (no CSLC), parse_failed (with the line), empty_input,
///        non_finite, non_planar, bad_contour (label out of range), too_large
/// @cost  O(bytes + #planes^2); allocates nothing on the word of a declared count
[[nodiscard]] Result<SliceFile> read_csl(const std::filesystem::path& path);

/// The same from text in memory; `name` is what messages call it.
[[nodiscard]] Result<SliceFile> parse_csl(std::string_view text, std::string_view name);

/// Writes slices as a CSL file with fields of view and unknown regions; the file is replaced. Numbers have all digits:
/// what read_csl() makes of it has every point within 1e-12 of the largest coordinate of where it was, in an image
/// frame of its own. Ids and times are not written.
/// @pre   make_section() accepts every slice
/// @error io_failed
/// @cost  O(bytes), one buffer of the size of the file
[[nodiscard]] Result<void> write_csl(std::span<const TrackedSlice> slices, const std::filesystem::path& path);

/// The same as text in memory.
[[nodiscard]] std::string csl_text(std::span<const TrackedSlice> slices);

/// Reads a .contour file: planes with ax+by+cz+d=0 or =d, vertices, edges with the labels left and right of them. The
/// boundary of every label's regions is traced into loops; which sign and which side the file means is told from its
/// vertices (the plane they lie in) and its edges (0 is the label far away).
/// @post, @error as read_csl; bad_contour also where the labels around a vertex contradict each other
/// @cost  O(bytes + #planes^2 + #E log #E)
[[nodiscard]] Result<SliceFile> read_contour(const std::filesystem::path& path);

/// The same from text in memory; `name` is what messages call it.
[[nodiscard]] Result<SliceFile> parse_contour(std::string_view text, std::string_view name);

}  // namespace sonoloft
