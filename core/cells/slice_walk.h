#pragma once
#include <array>
#include <vector>

#include "core/cells/cell_store.h"

namespace sonoloft {

[[nodiscard]] bool has_known_part(const FacePolygon& polygon);

/// The parts of a polygon in the image of `frame` below and above a plane; empty where there is none.
[[nodiscard]] std::array<FacePolygon, 2> parts_at(const CellStore& store, std::uint32_t plane,
                                                  const Eigen::Isometry3d& frame, FacePolygon polygon,
                                                  CellComplex::Work& work);

/// A part of a slice on its way down the tree.
struct Fragment {
  std::int32_t node;
  FacePolygon polygon;
};

/// The section as one labelled polygon that fills the box's cross-section.
[[nodiscard]] FacePolygon whole_section(const CellStore& store, const Section& section, CellComplex::Work& work);

/// Sends parts of a slice down the tree; what arrives in a leaf with a known part has reached that cell. Ascending.
[[nodiscard]] std::vector<Arrival> walk(const CellStore& store, const Eigen::Isometry3d& frame,
                                        std::vector<Fragment> fragments, CellComplex::Work& work);

}  // namespace sonoloft
