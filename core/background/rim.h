#pragma once
// Beside the stages:  slice -> [RIM] -> field (what lies behind the unknown parts of this slice's walls)
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/slice/section.h"

namespace sonoloft {

/// What labels weigh at points.
struct PointWeights {
  std::vector<Label> labels;  ///< [#L] ascending
  std::vector<float> weight;  ///< [#L][#P] >= 0
};

/// The border between what a slice shows and what it does not: close to it, it knows better than the nodes of the
/// background what lies in the unknown part of its plane. Label l weighs there, against 1 for the background's share,
///   B_l(x) = H * sum over pieces e of the border with l on the known side of  s_e c_e(x) integral_e |d phi| / |y - x|
/// phi the angle around x, H the background's spacing, c = (1 - (d / 8H)^4)^2 of the distance d from x to the middle of
/// the piece, 0 beyond 8 H; s = 20 on borders around a shadow that known parts enclose, else 1: between known parts a
/// border says more than beyond their end. On the border itself B is infinite. It depends on the slice alone: the same
/// from both sides of every wall. Frame: reference, mm. Threads: const members may run together.
/// Source: the second term of equation 7 of Bermano, Vaxman, Gotsman 2011, taken at the point;
/// docs/pipeline/9-background.md.
class Rim {
 public:
  /// @param spacing_mm  H > 0
  /// @cost  O(edges + border / H, times the logarithm of it)
  Rim(const Section& section, double spacing_mm);

  /// Whether something may weigh more than 0 within this radius of a point. @cost O(pieces near it)
  [[nodiscard]] bool reaches(const Eigen::Vector3d& centre_mm, double radius_mm) const;

  /// Weighs the labels at points that lie near each other. What a point gets depends on it alone, to the last bit.
  /// @cost O(#P * pieces near them), 5 ns each
  void weigh(std::span<const Eigen::Vector3d> points_mm, PointWeights& out) const;

 private:
  /// At most 2 H of the border. Frame: image, mm.
  struct Piece {
    float ax, ay, bx, by, scale;
    std::uint32_t label;  ///< index
  };
  /// Pieces are kept by tile of a grid over the image, row by row.
  struct Tiles {
    Eigen::Vector2d origin = Eigen::Vector2d::Zero();
    Eigen::Array2i count = Eigen::Array2i::Ones();
    std::vector<std::uint32_t> first{0, 0};  ///< [#tiles + 1] in pieces_
  };
  void sort_into_tiles();
  [[nodiscard]] Eigen::Array2i tile_of(const Eigen::Vector2d& point) const;
  /// Calls visit(first, last) for runs of pieces, ascending: all that may lie within reach of a ball are among them.
  template <class Visit>
  void for_each_run(const Eigen::Vector3d& centre, double radius_mm, Visit visit) const;

  Eigen::Isometry3d reference_to_image_;
  double reach_mm_;
  std::vector<Label> labels_;
  std::vector<Piece> pieces_;
  Tiles tiles_;
};

}  // namespace sonoloft
