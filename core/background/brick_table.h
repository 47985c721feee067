#pragma once
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/slice/label.h"

namespace sonoloft {

inline constexpr int kBrickEdge = 8;  ///< nodes
inline constexpr int kBrickNodes = kBrickEdge * kBrickEdge * kBrickEdge;

/// Of a node in its brick; takes the node's place in the lattice as well as in the brick.
[[nodiscard]] inline std::size_t node_index(int x, int y, int z) {
  return static_cast<std::size_t>((x & 7) + 8 * (y & 7) + 64 * (z & 7));
}
[[nodiscard]] inline Eigen::Vector3i brick_of(const Eigen::Vector3i& node) {
  return {node.x() >> 3, node.y() >> 3, node.z() >> 3};
}
[[nodiscard]] inline Eigen::AlignedBox3i nodes_of(const Eigen::Vector3i& brick) {
  return {kBrickEdge * brick, (kBrickEdge * brick).array() + (kBrickEdge - 1)};
}

/// Calls visit(p) for every p of a box of whole numbers, ends included, x fastest.
template <class Visit>
void for_each_in(const Eigen::AlignedBox3i& box, Visit visit) {
  for (int z = box.min().z(); z <= box.max().z(); ++z)
    for (int y = box.min().y(); y <= box.max().y(); ++y)
      for (int x = box.min().x(); x <= box.max().x(); ++x) visit(Eigen::Vector3i(x, y, z));
}

/// A number for every node of a brick and every label that has any there.
template <class T>
struct LabelRows {
  using Row = std::array<T, kBrickNodes>;
  std::vector<Label> labels;  ///< ascending
  std::vector<Row> rows;      ///< [#labels]

  [[nodiscard]] const Row* find(Label label) const {
    const auto it = std::lower_bound(labels.begin(), labels.end(), label);
    return it == labels.end() || *it != label ? nullptr : &rows[static_cast<std::size_t>(it - labels.begin())];
  }
  /// The label's row, added with zeros when it is new.
  Row& find_or_add(Label label) {
    const auto it = std::lower_bound(labels.begin(), labels.end(), label);
    const auto at = it - labels.begin();
    if (it == labels.end() || *it != label) {
      labels.insert(it, label);
      rows.insert(rows.begin() + at, Row{});
    }
    return rows[static_cast<std::size_t>(at)];
  }
  void remove_zero_rows() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (std::all_of(rows[i].begin(), rows[i].end(), [](T v) { return v == 0; })) continue;
      labels[kept] = labels[i];
      if (kept != i) rows[kept] = rows[i];
      ++kept;
    }
    labels.resize(kept);
    rows.resize(kept);
  }
};

/// The bricks of a lattice of nodes (0,0,0) .. size - 1 that have something to say.
template <class Brick>
class BrickTable {
 public:
  explicit BrickTable(const Eigen::Vector3i& size)
      : nodes_(Eigen::Vector3i::Zero(), size.array() - 1),
        bricks_(Eigen::Vector3i::Zero(), brick_of(nodes_.max())),
        extent_(bricks_.sizes().array() + 1),
        table_(static_cast<std::size_t>(extent_.prod())) {}

  [[nodiscard]] const Eigen::AlignedBox3i& nodes() const { return nodes_; }    ///< ends included
  [[nodiscard]] const Eigen::AlignedBox3i& bricks() const { return bricks_; }  ///< ends included
  [[nodiscard]] std::size_t capacity() const { return table_.size(); }
  /// A number below capacity(), ascending by z, y, x. @pre the brick lies in bricks()
  [[nodiscard]] std::size_t index(const Eigen::Vector3i& brick) const {
    return static_cast<std::size_t>(brick.x() + extent_.x() * (brick.y() + extent_.y() * brick.z()));
  }
  [[nodiscard]] Eigen::Vector3i brick(std::size_t index) const {
    const int i = static_cast<int>(index);
    return {i % extent_.x(), i / extent_.x() % extent_.y(), i / extent_.x() / extent_.y()};
  }

  /// Null where there is none, and beyond the lattice.
  [[nodiscard]] const Brick* find(const Eigen::Vector3i& brick) const {
    return bricks_.contains(brick) ? table_[index(brick)].get() : nullptr;
  }
  Brick& find_or_add(std::size_t index) {
    if (!table_[index]) table_[index] = std::make_unique<Brick>();
    return *table_[index];
  }
  /// Empty, or the brick.
  [[nodiscard]] std::unique_ptr<Brick>& operator[](std::size_t index) { return table_[index]; }
  [[nodiscard]] const std::unique_ptr<Brick>& operator[](std::size_t index) const { return table_[index]; }

 private:
  Eigen::AlignedBox3i nodes_, bricks_;
  Eigen::Vector3i extent_;
  std::vector<std::unique_ptr<Brick>> table_;
};

/// What the slices say around each node: weights in units of 1 / kWeightUnit.
struct NodeData {
  std::array<std::uint32_t, kBrickNodes> weight{};  ///< of all labels, outside among them
  LabelRows<std::uint32_t> of_label;                ///< of every other label that occurs

  [[nodiscard]] bool empty() const {
    return std::all_of(weight.begin(), weight.end(), [](std::uint32_t w) { return w == 0; });
  }
};
inline constexpr std::uint32_t kWeightUnit = 4096;

/// The solution at each node: shares in units of 1 / kShareUnit; what the labels leave is outside.
struct NodeShares {
  LabelRows<std::uint16_t> of_label;     ///< of every label but outside with a share in the brick
  std::array<Label, kBrickNodes> top{};  ///< the label with the largest share, lowest of equals
};
inline constexpr int kShareUnit = 256;

/// Which nodes of a lattice changed: a box in every brick that has any.
class ChangedNodes {
 public:
  explicit ChangedNodes(std::size_t bricks) : box_(bricks) {}
  void extend(std::size_t brick, const Eigen::AlignedBox3i& nodes) {
    if (nodes.isEmpty()) return;
    if (box_[brick].isEmpty()) bricks_.push_back(brick);
    box_[brick].extend(nodes);
  }
  [[nodiscard]] const std::vector<std::size_t>& bricks() const { return bricks_; }
  [[nodiscard]] const Eigen::AlignedBox3i& box(std::size_t brick) const { return box_[brick]; }
  void clear() {
    for (const std::size_t b : bricks_) box_[b].setEmpty();
    bricks_.clear();
  }

 private:
  std::vector<Eigen::AlignedBox3i> box_;  ///< [#bricks]
  std::vector<std::size_t> bricks_;       ///< with a box, in no order
};

}  // namespace sonoloft
