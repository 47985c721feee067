#pragma once
// known parts of walls, patches -> [REGIONS] -> what every label weighs at a point
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace sonoloft {

/// Share of a label that is linear over a plane: value + gradient . y. Frame: image of the plane, mm.
struct LinearShare {
  double value = 0;
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
};

inline constexpr std::size_t kPointLanes = 8;
using PointLanes = std::array<double, kPointLanes>;

/// Scales what labels weigh to shares that sum to 1; where there is nothing, all is the first label's. [#labels]
void normalise(std::span<PointLanes> weights);

/// Points that are weighed together; what is not needed repeats another. Frame: reference, mm.
struct PointBlock {
  PointLanes x, y, z;
  /// The points [first, first + kPointLanes), the last one repeated. @pre first < points.size()
  PointBlock(std::span<const Eigen::Vector3d> points, std::size_t first);
};

/// Regions of a plane over which labels have linear shares, and for every label l
///   integral over the regions of  L_l(y) |h| / |y - x|^4  dA        [1/mm]
/// as a sum over the borders of the regions with one angle each; h = height of x over the plane, on either side of it.
/// For a border a -> b with the region left of it, p the foot of x, e = b - a, D = (a - p) x e:
///   1/2 q (L(p) D / |h| - |h| (g x e)),   q = theta / |(a - x) x (b - x)|,  theta the angle under which x sees it.
/// Borders between regions are summed once, with the difference of the two functions (of constants: the difference of
/// the two values), and not at all where there is none.
class PlaneRegions {
 public:
  /// @param min_height_mm  points nearer to the plane are held that far off it: where the integral is not bounded, what
  ///                       is nearest decides
  PlaneRegions(const Eigen::Isometry3d& image_to_reference, double min_height_mm)
      : reference_to_image_(image_to_reference.inverse(Eigen::Isometry)), min_height_mm_(min_height_mm) {}

  /// A border with a region on its left in which label `slot` has this share; all of a region's borders close it.
  void add(const Eigen::Vector2d& a, const Eigen::Vector2d& b, std::uint32_t slot, const LinearShare& share);
  /// After the last add(), before weigh(): joins borders that regions share. @cost O(#borders log #borders)
  void finish();

  /// Adds the integrals at the points of a block. A point's depend on it alone, to the last bit.
  /// @param sums  [#slots]
  /// @cost  O(borders), 5 to 40 ns each for a point
  void weigh(const PointBlock& block, std::span<PointLanes> sums) const;

  [[nodiscard]] std::size_t border_count() const { return borders_.size(); }

 private:
  /// One label's part of a border.
  struct Piece {
    std::array<std::int64_t, 4> key;  ///< ends, rounded; the lower one first
    Eigen::Vector2d a, b;
    std::uint32_t slot;
    LinearShare share;
  };
  struct Border {
    double x, y, along_x, along_y, length2;
    std::uint32_t first_term, term_count;
  };
  struct Term {
    std::uint32_t slot;
    LinearShare share;
  };
  Eigen::Isometry3d reference_to_image_;
  double min_height_mm_;
  std::vector<Piece> pieces_;  ///< until finish()
  std::vector<Border> borders_;
  std::vector<Term> terms_;
};

}  // namespace sonoloft
