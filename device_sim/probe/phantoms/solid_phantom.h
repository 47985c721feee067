#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "device_sim/probe/phantom.h"

namespace sonoloft::device_sim {

/// A body given by a formula. Frame: reference, mm. Made by the functions below.
struct Solid {
  enum class Shape { ellipsoid, box, capsule, torus };
  Shape shape;
  Eigen::Isometry3d reference_to_solid;
  Eigen::Vector3d size_mm;  ///< ellipsoid: half axes; box: half edges; capsule: radius, half length along z, unused;
                            ///< torus about z: ring radius, tube radius, unused
  Label label;              ///< kOutside carves a cavity
};

/// @pre all lengths > 0
[[nodiscard]] Solid sphere(const Eigen::Vector3d& centre_mm, double radius_mm, Label label);
[[nodiscard]] Solid ellipsoid(const Eigen::Isometry3d& solid_to_reference, const Eigen::Vector3d& half_axes_mm,
                              Label label);
[[nodiscard]] Solid box(const Eigen::Isometry3d& solid_to_reference, const Eigen::Vector3d& half_edges_mm, Label label);
/// All points nearer than the radius to the segment from -> to.
[[nodiscard]] Solid capsule(const Eigen::Vector3d& from_mm, const Eigen::Vector3d& to_mm, double radius_mm,
                            Label label);
[[nodiscard]] Solid torus(const Eigen::Isometry3d& solid_to_reference, double ring_radius_mm, double tube_radius_mm,
                          Label label);

/// Solids one over the other: a point has the label of the last solid that holds it, so organs touch, nest and are
/// pierced. Sections are traced on a fine grid; what is thinner than spacing_mm() may be missed, points on borders are
/// exact to 1e-6 of it.
class SolidPhantom final : public Phantom {
 public:
  /// @pre at least one solid with a label
  explicit SolidPhantom(std::vector<Solid> solids);

  [[nodiscard]] Eigen::AlignedBox3d bounds() const override { return bounds_; }
  /// @cost O(#solids)
  [[nodiscard]] Label label_at(const Eigen::Vector3d& point_mm) const override;
  /// @cost O((extent / spacing)^2 #solids)
  [[nodiscard]] PhantomSection section(const Eigen::Isometry3d& plane_to_reference) const override;
  /// @cost that of section() by the window's share of the plane
  [[nodiscard]] PhantomSection section_in(const Eigen::AlignedBox2d& window,
                                          const Eigen::Isometry3d& plane_to_reference) const override;
  /// The distance of the grid's lines, 1/400 of the diagonal of bounds(); points of a loop are one to three of it
  /// apart.
  [[nodiscard]] double spacing_mm() const { return spacing_mm_; }

 private:
  std::vector<Solid> solids_;
  std::vector<Eigen::AlignedBox3d> boxes_;  ///< [#solids] a box around each
  Eigen::AlignedBox3d bounds_;
  double spacing_mm_;
};

/// The labels of organs_phantom().
enum class Organ : Label { body = 1, liver = 2, kidney = 3, tumour = 4, vessel = 5 };

/// An abdomen of 160 x 110 x 200 mm: a body; liver and kidney in it that touch; a tumour in the liver; a vessel through
/// body, liver and tumour; a bowel with gas (outside) in it.
[[nodiscard]] SolidPhantom organs_phantom();

}  // namespace sonoloft::device_sim
