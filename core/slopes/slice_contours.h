#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cells/cell_complex.h"
#include "core/slopes/contour/arc_shape.h"
#include "core/slopes/contour/arcs.h"
#include "core/slopes/contour/border_tree.h"
#include "core/slopes/vertex_bend.h"

namespace sonoloft {

inline constexpr std::uint32_t kNoCell = 0xFFFFFFFF;
inline constexpr std::uint32_t kSeveralCells = 0xFFFFFFFE;

/// What the planes of one of the two cells at a place say about the slope there.
struct PlaneSums {
  std::uint32_t cell = kNoCell;
  float slopes = 0, weights = 0;  ///< of least squares: their quotient is the slope
  float nearness2_per_mm2 = 0;    ///< 1 / way along the normal to the nearest plane, squared

  friend bool operator==(const PlaneSums&, const PlaneSums&) = default;
};

/// The slope where the contours of two slices cross.
struct Crossing {
  std::uint32_t arc;
  float along_mm, angle;  ///< angle: atan(slope)
  SliceId other;
};

/// The contours of one slice, what others say about them, and what follows.
struct SliceContours {
  SliceContours(const Section& section, double feature_mm);

  Eigen::Isometry3d image_to_reference, reference_to_image;
  Section calm;  ///< calmed(): all below is of its contours
  Arcs arcs;
  ArcShape shape;
  BorderTree borders;
  std::vector<std::uint8_t> is_station;  ///< [#places] slopes are computed there, others lie near one
  std::vector<float> fading_per_mm;      ///< [#places]

  std::vector<std::array<PlaneSums, 2>> sums;            ///< [#places] of the cell below and of the one above
  std::vector<std::array<std::uint32_t, 2>> edge_cells;  ///< [#edges] likewise: where the whole edge lies in one wall
  std::uint8_t walls_changed = 0;                        ///< some place came to lie on a wall, or left it
  std::vector<Crossing> crossings;

  std::vector<float> slope;                ///< [#places]
  std::vector<VertexBend> bends;           ///< [#points]
  std::vector<std::uint8_t> arc_is_stale;  ///< [#arcs] slope is to be computed again

  [[nodiscard]] Eigen::Vector3d normal() const { return image_to_reference.linear().col(2); }
  void forget(const std::vector<bool>& is_removed);    ///< [#cells] what was said in them
  void drop_crossings(const std::vector<bool>& with);  ///< [#slices]
  void add_crossings(std::span<const Crossing> more);
  [[nodiscard]] bool is_stale() const;
  [[nodiscard]] bool is_on_walls() const;
  [[nodiscard]] bool is_on_wall(std::uint32_t place) const;  ///< or the stations around it
};

}  // namespace sonoloft
