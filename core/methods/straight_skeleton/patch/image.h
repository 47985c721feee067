#pragma once
#include <Eigen/Geometry>

#include "core/methods/straight_skeleton/exact/form.h"

namespace sonoloft::skeleton {

/// A point of an image, mm.
struct Spot {
  Spot() = default;
  explicit Spot(const Eigen::Vector2d& p) : x(p.x()), y(p.y()), rough(p) {}
  Spot(Exact px, Exact py);
  Exact x, y;
  Eigen::Vector2d rough = Eigen::Vector2d::Zero();
};

/// +1 where c lies left of a -> b.
[[nodiscard]] int turn(const Spot& a, const Spot& b, const Spot& c);
/// a + t (b - a)
[[nodiscard]] Spot between(const Spot& a, const Spot& b, const Exact& t);
/// (b - a) x (d - c)
[[nodiscard]] Exact cross(const Spot& a, const Spot& b, const Spot& c, const Spot& d);

/// The frame of a slice, its doubles taken exactly. Everything of the image is told as forms on space that do not
/// change along the normal: so a point of space has a foot without any arithmetic.
class Image {
 public:
  explicit Image(const Eigen::Isometry3d& frame);

  FormPtr height;  ///< distance from the plane, positive where the normal points to
  /// Distance from the line through a and b, positive left of it.
  [[nodiscard]] FormPtr line(const Spot& a, const Spot& b) const;
  /// How far a point is beyond `at` in the direction from a to b.
  [[nodiscard]] FormPtr along(const Spot& a, const Spot& b, const Spot& at) const;
  /// a x + b y + c of the image coordinates, times a number that is 1 to rounding.
  [[nodiscard]] FormPtr form(const Exact& a, const Exact& b, const Exact& c) const;

  [[nodiscard]] Corner place(const Spot& p) const;
  /// A direction of space in the image.
  [[nodiscard]] Eigen::Vector2d direction(const Eigen::Vector3d& d) const { return rough_axes_.transpose() * d; }
  [[nodiscard]] Eigen::Vector3d direction(const Eigen::Vector2d& d) const { return rough_axes_ * d; }
  [[nodiscard]] Eigen::Vector2d foot(const Corner& p) const;
  /// x of the point's foot less another one, times a positive number.
  [[nodiscard]] int compare_x(const Corner& p, const Spot& q) const;

 private:
  std::array<Exact, 3> origin_, x_axis_, y_axis_;
  FormPtr x_, y_;  ///< image coordinates times unit_
  Exact unit_;
  Eigen::Matrix<double, 3, 2> rough_axes_;
};

}  // namespace sonoloft::skeleton
