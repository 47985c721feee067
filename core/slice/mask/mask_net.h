#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/slice/mask/label_mask.h"

namespace sonoloft::mask {

/// Sides of a corner: the next corner in this direction.
enum Direction : std::uint8_t { kEast, kSouth, kWest, kNorth };
inline constexpr std::uint32_t kNoVertex = ~std::uint32_t{0};

/// The corners of pixels at which labels meet, joined where a side of a pixel parts two labels.
struct MaskNet {
  struct Vertex {
    std::int32_t x, y;                          ///< of the corner: of the pixel to the south-east of it
    std::array<std::uint32_t, 4> to;            ///< by direction; kNoVertex: labels do not differ there
    std::array<Label, 4> label_left;            ///< of the border in that direction, seen along it
    int degree;                                 ///< 2, 3 or 4
    bool on_vertical_edge, on_horizontal_edge;  ///< of the image
  };

  std::vector<Vertex> vertices;           ///< [#V] row after row
  std::vector<Eigen::Vector2d> position;  ///< [#V] pixels, the centre of the first pixel is (0, 0)
};

/// The net of a mask, its vertices at the corners. @cost O(pixels)
[[nodiscard]] MaskNet make_net(const LabelMask& mask);

/// Takes the staircase out: vertices move, by at most 0.4 pixels along each axis.
void smooth(MaskNet& net);

/// Which vertices are needed to keep every border within `tolerance` pixels. Ends of borders always are.
[[nodiscard]] std::vector<char> needed_vertices(const MaskNet& net, double tolerance);

}  // namespace sonoloft::mask
