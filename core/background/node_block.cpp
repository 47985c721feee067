#include "core/background/node_block.h"

namespace sonoloft {

NodeBlock::NodeBlock(const NodeLattice& lattice, std::span<const Eigen::Vector3d> points_mm, int grown_by) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : points_mm) box.extend(p);
  nodes_ = lattice.nodes_around(box);
  nodes_ = {nodes_.min().array() - grown_by, nodes_.max().array() + grown_by};
  const auto size = (nodes_.sizes().array() + 1).cast<std::size_t>().eval();
  stride_y_ = size.x();
  stride_z_ = size.x() * size.y();
  places_.reserve(points_mm.size());
  for (const Eigen::Vector3d& p : points_mm) {
    const Eigen::Vector3d steps = lattice.steps(p), low = steps.array().floor();
    const Eigen::Vector3f offset = (steps - low).cast<float>();
    places_.push_back({static_cast<std::uint32_t>(at(low.cast<int>())), offset.x(), offset.y(), offset.z()});
  }
}

void NodeBlock::interpolate(std::span<float> out) const {
  const std::size_t up = stride_y_, behind = stride_z_;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Place& p = places_[i];
    const auto along_x = [&p](const float* v) { return v[0] + p.x * (v[1] - v[0]); };
    const float* v = value_.data() + p.node;
    const float a = along_x(v), b = along_x(v + up), c = along_x(v + behind), d = along_x(v + behind + up);
    const float front = a + p.y * (b - a), back = c + p.y * (d - c);
    out[i] = front + p.z * (back - front);
  }
}

}  // namespace sonoloft
