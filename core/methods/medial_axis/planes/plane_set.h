#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "core/methods/network/exact.h"

namespace sonoloft::medial {

using namespace network;

/// A plane as CellComplex takes it: its normal and offset are doubles, taken exactly. They are all that "distance"
/// means here, so that points of equal distance are rational; a normal is a unit vector to rounding only. Image
/// coordinates lie exactly in the plane: the frame's axes, freed of what rounding left of the normal in them.
struct ExactPlane {
  Eigen::Isometry3d frame;
  Triple normal, origin, x, y;
  Triple dual_x, dual_y;  ///< the image coordinates of a point's foot are dual . (point - origin)
  Number offset;
};

/// a x + b y + c: what the distance from another plane is at an image point of this one.
struct Trace {
  Number a, b, c;
  double fa, fb, fc;  ///< rounded
  [[nodiscard]] double approx(const Eigen::Vector2d& p) const { return fa * p.x() + fb * p.y() + fc; }
  [[nodiscard]] Number at(const Point& p) const { return a * p.x() + b * p.y() + c; }
};

/// All planes, and each as every other one sees it. Threads: const after construction; numbers are shared safely.
class PlaneSet {
 public:
  /// @param scale_mm  upper bound of coordinates @cost O(#planes^2)
  PlaneSet(std::span<const Eigen::Isometry3d> frames, double scale_mm);

  [[nodiscard]] std::size_t size() const { return planes_.size(); }
  [[nodiscard]] const ExactPlane& operator[](std::size_t plane) const { return planes_[plane]; }
  [[nodiscard]] const Trace& trace(std::size_t on, std::size_t of) const { return traces_[on * planes_.size() + of]; }
  /// The product of two normals.
  [[nodiscard]] const Number& normals(std::size_t f, std::size_t g) const { return normals_[f * planes_.size() + g]; }

  /// What a rounded distance must exceed for its sign to be sure, mm.
  [[nodiscard]] double doubt_mm() const { return doubt_mm_; }
  /// On which side of a plane a point of another one lies, exactly. @param rounded  the point, to a few units
  [[nodiscard]] int side(std::size_t on, std::size_t of, const Point& p, const Eigen::Vector2d& rounded) const;

  [[nodiscard]] Triple point(std::size_t plane, const Point& p) const;
  [[nodiscard]] Point foot(std::size_t plane, const Triple& p) const;

 private:
  std::vector<ExactPlane> planes_;
  std::vector<Trace> traces_;
  std::vector<Number> normals_;
  double doubt_mm_;
};

}  // namespace sonoloft::medial
