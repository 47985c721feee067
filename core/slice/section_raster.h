#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "core/slice/section.h"

namespace sonoloft {

/// The labels of a slice at the points of a square grid over that part of it which lies in a box. The grid is anchored
/// to the image's origin: the same slice has its points in the same places wherever the box ends. Every point stands
/// for spacing^2 of area. Frame: image, mm.
struct SectionRaster {
  double spacing_mm = 1;
  Eigen::Vector2d first = Eigen::Vector2d::Zero();  ///< whole numbers: grid coordinates of pixel (0, 0)
  int width = 0, height = 0;                        ///< both 0 when nothing known can lie in the box
  std::vector<Label> label;  ///< [height][width] kUnknown also where the point is not in the box; the outermost rows
                             ///< and columns are kUnknown throughout

  [[nodiscard]] Eigen::Vector2d point(int x, int y) const {
    return spacing_mm * (first + Eigen::Vector2d(x + 0.5, y + 0.5));
  }
  [[nodiscard]] Label at(int x, int y) const {
    return label[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

/// @pre   spacing_mm > 0; the section is as make_section() gives it; the box is not empty (its section at this spacing
///        is what is stored)
/// @post  a function of the section, the spacing and the box alone
/// @cost  O(edges met by rows + pixels); a point on a border has either label
/// Threads: any. Source: scan lines; borders that meet are ordered by exact orientation.
[[nodiscard]] SectionRaster rasterize(const Section& section, double spacing_mm, const Eigen::AlignedBox3d& box);

}  // namespace sonoloft
