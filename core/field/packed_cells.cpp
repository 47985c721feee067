#include "core/field/packed_cells.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace sonoloft {
namespace {

/// Diameter of the smallest ball around the centre that holds the cell; 0 when the faces have no edges.
double size_mm(std::span<const CellFace> faces, const Eigen::Vector3d& centre_mm) {
  double radius2 = 0;
  for (const CellFace& face : faces) {
    const Eigen::Vector3d centre = face.image_to_reference->inverse() * centre_mm;
    for (const FaceEdge& edge : *face.polygon)
      radius2 = std::max(radius2, (edge.a - centre.head<2>()).squaredNorm() + centre.z() * centre.z());
  }
  return 2 * std::sqrt(radius2);
}

std::uint32_t slot_of(Label label, std::span<const Label> slots, std::uint32_t unknown_slot) {
  if (label == kBeyondFace) return SONOLOFT_NO_SLOT;
  if (label == kUnknown) return unknown_slot;
  return static_cast<std::uint32_t>(std::lower_bound(slots.begin(), slots.end(), label) - slots.begin());
}

}  // namespace

void PackedCells::clear() {
  cells_.clear();
  faces_.clear();
  runs_.clear();
  edges_.clear();
  labels_.clear();
  centres_mm_.clear();
}

std::uint32_t PackedCells::add(std::span<const CellFace> faces, const Eigen::Vector3d& centre_mm,
                               std::span<const std::uint32_t> apart) {
  const auto index = static_cast<std::uint32_t>(cells_.size());
  const auto first_label = static_cast<std::uint32_t>(labels_.size());
  const auto first_face = static_cast<std::uint32_t>(faces_.size());
  collect_labels(faces, apart);
  const std::span<const Label> slots(labels_.data() + first_label, labels_.size() - first_label);
  if (slots.size() > 1) {
    const double unit_mm = size_mm(faces, centre_mm);
    const auto first_unknown =
        static_cast<std::uint32_t>(std::lower_bound(slots.begin(), slots.end(), kUnknown) - slots.begin());
    auto next_apart = static_cast<std::uint32_t>(slots.size() - apart.size());
    for (std::uint32_t i = 0; i < faces.size(); ++i) {
      const bool is_apart = std::binary_search(apart.begin(), apart.end(), i);
      add_face(faces[i], centre_mm, unit_mm, slots, is_apart ? next_apart++ : first_unknown);
    }
  }
  const auto face_count = static_cast<std::uint32_t>(faces_.size()) - first_face;
  cells_.push_back({first_face, face_count, static_cast<std::uint32_t>(slots.size()), first_label});
  centres_mm_.push_back(centre_mm);
  return index;
}

std::uint32_t PackedCells::edge_count(std::uint32_t cell) const {
  std::uint32_t count = 0;
  const kernels::PackedCell& c = cells_[cell];
  for (const kernels::PackedFace& face : faces().subspan(c.first_face, c.face_count))
    for (const kernels::PackedRun& run : runs().subspan(face.first_run, face.run_count)) count += run.edge_count;
  return count;
}

/// Appends the slots of a cell to labels_. A cell with nothing but slivers for faces is unknown.
void PackedCells::collect_labels(std::span<const CellFace> faces, std::span<const std::uint32_t> apart) {
  const auto first = static_cast<std::ptrdiff_t>(labels_.size());
  const auto note = [&](Label label) {
    if (label == kBeyondFace) return;
    const auto at = std::lower_bound(labels_.begin() + first, labels_.end(), label);
    if (at == labels_.end() || *at != label) labels_.insert(at, label);
  };
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    const bool is_apart = std::binary_search(apart.begin(), apart.end(), i);
    for (const FaceEdge& edge : *faces[i].polygon)
      for (const Label label : {edge.left, edge.right})
        if (label != kUnknown || !is_apart) note(label);
  }
  labels_.insert(labels_.end(), apart.size(), kUnknown);
  if (static_cast<std::ptrdiff_t>(labels_.size()) == first) note(kUnknown);
}

void PackedCells::add_face(const CellFace& face, const Eigen::Vector3d& centre_mm, double unit_mm,
                           std::span<const Label> slots, std::uint32_t unknown_slot) {
  const Eigen::Vector3d centre = face.image_to_reference->inverse() * centre_mm;
  scratch_.clear();
  for (const FaceEdge& edge : *face.polygon) {
    std::uint32_t left = slot_of(edge.left, slots, unknown_slot), right = slot_of(edge.right, slots, unknown_slot);
    // The sum over an edge changes sign with its direction, so every pair of labels needs one run only.
    const bool turn = left > right;
    if (turn) std::swap(left, right);
    const Eigen::Vector2f start = (((turn ? edge.b : edge.a) - centre.head<2>()) / unit_mm).cast<float>();
    const Eigen::Vector2f along = ((turn ? edge.a - edge.b : edge.b - edge.a) / unit_mm).cast<float>();
    const float length2 = along.squaredNorm();
    if (length2 > 0)
      scratch_.push_back({{start.x(), start.y(), along.x(), along.y(), length2},
                          left,
                          right,
                          static_cast<std::uint32_t>(scratch_.size())});
  }
  if (scratch_.empty()) return;
  std::sort(scratch_.begin(), scratch_.end(), [](const SlottedEdge& a, const SlottedEdge& b) {
    return std::tie(a.left, a.right, a.order) < std::tie(b.left, b.right, b.order);
  });

  const auto first_run = static_cast<std::uint32_t>(runs_.size());
  for (const SlottedEdge& e : scratch_) {
    if (runs_.size() == first_run || runs_.back().left != e.left || runs_.back().right != e.right)
      runs_.push_back({static_cast<std::uint32_t>(edges_.size()), 0, e.left, e.right});
    ++runs_.back().edge_count;
    edges_.push_back(e.edge);
  }
  // The in-plane sums are the same seen from either side of the plane; only the height must count from the cell's side.
  const Eigen::Matrix3d& axes = face.image_to_reference->linear();
  const double side = (face.above ? 1 : -1) / unit_mm;
  const Eigen::Vector3f u = (axes.col(0) / unit_mm).cast<float>();
  const Eigen::Vector3f v = (axes.col(1) / unit_mm).cast<float>();
  const Eigen::Vector3f n = (axes.col(2) * side).cast<float>();
  faces_.push_back({u.x(), u.y(), u.z(), v.x(), v.y(), v.z(), n.x(), n.y(), n.z(),
                    static_cast<float>(centre.z() * side), first_run,
                    static_cast<std::uint32_t>(runs_.size()) - first_run});
}

}  // namespace sonoloft
