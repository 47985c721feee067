#include "core/background/slice_splat.h"

#include <array>
#include <cmath>

namespace sonoloft {
namespace {

/// Two nodes along one axis and what each gets.
struct Pair {
  int low;
  double share[2];
  explicit Pair(double steps) : low(static_cast<int>(std::floor(steps))) {
    share[1] = steps - low;
    share[0] = 1 - share[1];
  }
};

/// Adds to nodes one after the other: those that follow each other mostly share brick and label, which are looked up
/// when they change.
class NodeWriter {
 public:
  NodeWriter(BrickTable<NodeData>& data, ChangedNodes& changed) : data_(data), changed_(changed) {}
  ~NodeWriter() { leave_brick(); }
  NodeWriter(const NodeWriter&) = delete;
  NodeWriter& operator=(const NodeWriter&) = delete;

  /// @pre the table has the node
  void add(const Eigen::Vector3i& node, Label label, std::uint32_t change) {
    if (const Eigen::Vector3i brick = brick_of(node); there_ == nullptr || brick != brick_) enter_brick(brick);
    if (label != kOutside && label != label_) {
      label_ = label;
      row_ = &there_->of_label.find_or_add(label);
    }
    const std::size_t at = node_index(node.x(), node.y(), node.z());
    there_->weight[at] += change;
    if (label != kOutside) (*row_)[at] += change;
    nodes_.extend(node);
  }

 private:
  void enter_brick(const Eigen::Vector3i& brick) {
    leave_brick();
    brick_ = brick;
    there_ = &data_.find_or_add(data_.index(brick));
    label_ = kOutside;
  }
  void leave_brick() {
    if (there_ != nullptr) changed_.extend(data_.index(brick_), nodes_);
    nodes_.setEmpty();
  }

  BrickTable<NodeData>& data_;
  ChangedNodes& changed_;
  Eigen::Vector3i brick_ = Eigen::Vector3i::Zero();
  NodeData* there_ = nullptr;  ///< null before the first node
  Label label_ = kOutside;     ///< of row_; outside: there is none yet
  LabelRows<std::uint32_t>::Row* row_ = nullptr;
  Eigen::AlignedBox3i nodes_;  ///< added to in this brick
};

}  // namespace

void splat(const NodeLattice& lattice, const Eigen::Isometry3d& image_to_reference, const SectionRaster& raster,
           int sign, BrickTable<NodeData>& data, ChangedNodes& changed) {
  const double pixel = raster.spacing_mm / lattice.spacing_mm, units = kWeightUnit * pixel * pixel;
  NodeWriter writer(data, changed);
  std::size_t at = 0;
  for (int row = 0; row < raster.height; ++row)
    for (int column = 0; column < raster.width; ++column, ++at) {
      if (raster.label[at] == kUnknown) continue;
      const Eigen::Vector2d p = raster.point(column, row);
      const Eigen::Vector3d steps = lattice.steps(image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0));
      const Pair x(steps.x()), y(steps.y()), z(steps.z());
      for (int corner = 0; corner < 8; ++corner) {
        const int i = corner & 1, j = (corner >> 1) & 1, k = corner >> 2;
        const Eigen::Vector3i node(x.low + i, y.low + j, z.low + k);
        const auto weight = static_cast<std::int32_t>(units * x.share[i] * y.share[j] * z.share[k] + 0.5);
        if (weight == 0 || !data.nodes().contains(node)) continue;
        writer.add(node, raster.label[at], static_cast<std::uint32_t>(sign * weight));  // to take away: modulo 2^32
      }
    }
}

}  // namespace sonoloft
