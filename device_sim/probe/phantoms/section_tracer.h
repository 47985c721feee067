#pragma once
#include <Eigen/Geometry>
#include <functional>

#include "device_sim/probe/phantom.h"

namespace sonoloft::device_sim {

/// The regions of equal label in a part of a plane, as loops: marching squares for any number of labels. Borders are
/// found on the lines of a grid by bisection (to 1e-6 of the spacing), the points where three or four regions meet by
/// subdivision; what is smaller than a square of the grid may be missed. Both sides of a border get identical points,
/// at least spacing_mm apart on longer borders. Every bounded region gives the loop around it; its own holes are the
/// loops of the regions within.
/// @param area      outside of it is outside; empty: no loops
/// @param label_at  called at points in the plane, also up to two spacings out of the area
/// @pre   spacing_mm > 0; it is made coarser where more than 4,096 lines would be needed
/// @cost  one call of label_at per node of the grid and about 20 per point of a border
[[nodiscard]] PhantomSection trace_section(const Eigen::AlignedBox2d& area, double spacing_mm,
                                           const std::function<Label(const Eigen::Vector2d&)>& label_at);

/// The same for labels given in space (reference, mm).
[[nodiscard]] PhantomSection trace_section(const Eigen::AlignedBox2d& area, const Eigen::Isometry3d& plane_to_reference,
                                           double spacing_mm,
                                           const std::function<Label(const Eigen::Vector3d&)>& label_at);

/// Around what a plane cuts out of a box, in the plane's frame; empty where they do not meet.
[[nodiscard]] Eigen::AlignedBox2d section_area(const Eigen::AlignedBox3d& box,
                                               const Eigen::Isometry3d& plane_to_reference);

}  // namespace sonoloft::device_sim
