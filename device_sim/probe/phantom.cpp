#include "device_sim/probe/phantom.h"

#include <array>

namespace sonoloft::device_sim {

double signed_area(std::span<const Eigen::Vector2d> loop) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
    const Eigen::Vector2d a = loop[i] - loop[0], b = loop[i + 1] - loop[0];  // keeps digits far from the origin
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

std::vector<Eigen::Vector2d> box_section(const Eigen::AlignedBox3d& box, const Eigen::Isometry3d& plane_to_reference) {
  std::vector<Eigen::Vector2d> corners;
  if (box.isEmpty()) return corners;
  const Eigen::Isometry3d reference_to_plane = plane_to_reference.inverse();
  std::array<Eigen::Vector3d, 8> p;  // bit 0, 1, 2 of the index: upper end along x, y, z
  for (unsigned i = 0; i < 8; ++i) {
    const Eigen::Vector3d corner(i & 1 ? box.max().x() : box.min().x(), i & 2 ? box.max().y() : box.min().y(),
                                 i & 4 ? box.max().z() : box.min().z());
    p[i] = reference_to_plane * corner;
  }
  for (unsigned i = 0; i < 8; ++i) {
    for (unsigned bit = 1; bit < 8; bit <<= 1) {
      const unsigned j = i | bit;
      if (j == i || (p[i].z() >= 0) == (p[j].z() >= 0)) continue;
      const double t = p[i].z() / (p[i].z() - p[j].z());
      corners.push_back((p[i] + t * (p[j] - p[i])).head<2>());
    }
  }
  return corners;
}

}  // namespace sonoloft::device_sim
