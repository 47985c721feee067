#include "core/methods/network/data_box.h"

namespace sonoloft::network {

Eigen::AlignedBox3d box_around(std::span<const Section> sections) {
  Eigen::AlignedBox3d data;
  for (const Section& s : sections)
    for (const Eigen::Vector2d& p : s.points) data.extend(s.image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0));
  if (data.isEmpty()) return data;
  const double least_mm = data.diagonal().norm() / 4;  // of a single slice
  const Eigen::Vector3d half = data.sizes().cwiseMax(least_mm);
  return {data.center() - half, data.center() + half};
}

}  // namespace sonoloft::network
