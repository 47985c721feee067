#pragma once
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "core/methods/straight_skeleton/exact/form.h"

namespace sonoloft::skeleton {

/// Six planes, positive within.
struct ExactBox {
  ExactBox(const Eigen::AlignedBox3d& box, double doubt_mm);
  std::array<FormPtr, 6> walls;  ///< x low, x high, y low, ...
  Eigen::AlignedBox3d box;
  double doubt_mm;
};

enum class Cut : std::uint8_t { some, none, along };  ///< what is left; `along`: the polygon lies in the plane

/// A convex polygon in a plane, counter-clockwise where that is positive. All corners are where its plane and two sides
/// meet, exactly.
struct Polygon {
  FormPtr support;
  std::vector<FormPtr> sides;  ///< [#corners] positive within, from each corner to the next
  std::vector<Corner> corners;

  /// All of a plane that lies in the box.
  [[nodiscard]] static Polygon across(const ExactBox& box, FormPtr support);
  /// Keeps what lies on the positive side; nothing where that has no area.
  Cut cut(const FormPtr& plane, double doubt_mm);
  [[nodiscard]] bool empty() const { return corners.empty(); }
};

/// The same in doubles, and never smaller: tells quickly what does not meet.
class RoughPolygon {
 public:
  /// Of a plane more than what lies in the box.
  RoughPolygon(const Eigen::AlignedBox3d& box, const Eigen::Vector4d& support, double slack_mm);
  RoughPolygon(const Polygon& polygon, double slack_mm);
  /// @return whether anything is left
  bool cut(const Eigen::Vector4d& plane);

 private:
  std::vector<Eigen::Vector3d> corners_, kept_;
  double slack_mm_;
};

}  // namespace sonoloft::skeleton
