#pragma once
#include <array>
#include <vector>

#include "core/cells/cell_store.h"

namespace sonoloft {

/// The part of a slice that lies in a cell.
struct Arrival {
  CellId cell;
  FacePolygon polygon;
};

[[nodiscard]] bool has_known_part(const FacePolygon& polygon);

/// The parts of a polygon in the image of `frame` below and above a plane; empty where there is none.
[[nodiscard]] std::array<FacePolygon, 2> parts_at(const CellStore& store, std::uint32_t plane,
                                                  const Eigen::Isometry3d& frame, FacePolygon polygon,
                                                  CellComplex::Work& work);

/// Sends the section down the tree; what arrives in a leaf with a known part has reached that cell. Ascending.
[[nodiscard]] std::vector<Arrival> walk(const CellStore& store, const Section& section, CellComplex::Work& work);

}  // namespace sonoloft
