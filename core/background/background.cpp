#include "core/background/background.h"

#include <cassert>

#include "core/background/cascade.h"
#include "core/background/node_block.h"
#include "core/background/seen_distance.h"
#include "core/background/slice_splat.h"
#include "core/background/surface_cells.h"

namespace sonoloft {
namespace {

static_assert(kBackgroundBrick == kBrickEdge);

constexpr int kPixelsPerSpacing = 2;
constexpr float kLeastWeight = 0.02f;  ///< below, local() knows nothing

Eigen::Vector3i node_count(const Eigen::AlignedBox3d& box, double spacing_mm) {
  assert(!box.isEmpty() && spacing_mm > 0 && box.sizes().maxCoeff() <= kBackgroundLargest * spacing_mm);
  // A whisker less, so that rounding adds no layer.
  return (box.sizes() / spacing_mm - Eigen::Vector3d::Constant(1e-6)).array().ceil().max(1.0).cast<int>();
}

/// Calls visit(brick, rows of its labels) for the bricks in a box that have any.
template <class Brick, class Visit>
void for_each_brick(const BrickTable<Brick>& table, const Eigen::AlignedBox3i& bricks, Visit visit) {
  const Eigen::AlignedBox3i there = bricks.intersection(table.bricks());
  if (there.isEmpty()) return;
  for_each_in(there, [&](const Eigen::Vector3i& b) {
    if (const Brick* brick = table.find(b)) visit(b, *brick);
  });
}

template <class Brick>
std::vector<Label> labels_in(const BrickTable<Brick>& table, const Eigen::AlignedBox3i& nodes) {
  std::vector<Label> labels{kOutside};
  for_each_brick(table, {brick_of(nodes.min()), brick_of(nodes.max())}, [&](const Eigen::Vector3i&, const Brick& b) {
    labels.insert(labels.end(), b.of_label.labels.begin(), b.of_label.labels.end());
  });
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  return labels;
}

/// Interpolated numbers of all labels but outside, whose row is left 0.
template <class Brick>
void interpolate_labels(const NodeLattice& lattice, const BrickTable<Brick>& table,
                        std::span<const Eigen::Vector3d> points_mm, float scale, PointShares& out) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : points_mm) box.extend(p);
  out.labels = points_mm.empty() ? std::vector<Label>{kOutside} : labels_in(table, lattice.nodes_around(box));
  out.share.assign(out.labels.size() * points_mm.size(), 0.0f);
  for_each_block(lattice, points_mm, 0, [&](std::size_t first, NodeBlock& block) {
    for (std::size_t l = 1; l < out.labels.size(); ++l) {
      block.clear();
      for_each_brick(table, block.bricks(), [&](const Eigen::Vector3i& at, const Brick& brick) {
        if (const auto* row = brick.of_label.find(out.labels[l])) block.set(at, *row);
      });
      block.interpolate(std::span(out.share).subspan(l * points_mm.size() + first));
    }
  });
  for (float& share : out.share) share *= scale;
}

/// Outside is what the others leave.
void fill_outside(PointShares& shares, std::size_t points) {
  std::fill_n(shares.share.begin(), points, 1.0f);
  for (std::size_t l = 1; l < shares.labels.size(); ++l)
    for (std::size_t i = 0; i < points; ++i) shares.share[i] -= shares.share[l * points + i];
}

}  // namespace

struct Background::State {
  NodeLattice lattice;
  Eigen::AlignedBox3d box;
  Cascade cascade;
  SurfaceCells surface;

  State(const Eigen::AlignedBox3d& box_mm, double spacing_mm)
      : lattice{box_mm.min(), spacing_mm},
        box(box_mm),
        cascade(node_count(box_mm, spacing_mm)),
        surface(node_count(box_mm, spacing_mm)) {}

  void splat_section(const Section& section, int sign) {
    const SectionRaster raster = rasterize(section, lattice.spacing_mm / kPixelsPerSpacing, box);
    splat(lattice, section.image_to_reference, raster, sign, cascade.data(), cascade.touched());
  }
};

Background::Background(const Eigen::AlignedBox3d& box, double spacing_mm)
    : state_(std::make_unique<State>(box, spacing_mm)) {}
Background::~Background() = default;
Background::Background(Background&&) noexcept = default;
Background& Background::operator=(Background&&) noexcept = default;

void Background::add(const Section& section) {
  state_->splat_section(section, 1);
}

void Background::remove(const Section& section) {
  state_->splat_section(section, -1);
}

std::vector<BackgroundChange> Background::update(int threads) {
  return state_->surface.update(state_->cascade.shares(), state_->cascade.solve(threads));
}

void Background::shares(std::span<const Eigen::Vector3d> points_mm, PointShares& out) const {
  interpolate_labels(state_->lattice, state_->cascade.shares(), points_mm, 1.0f / kShareUnit, out);
  fill_outside(out, points_mm.size());
}

std::vector<Label> Background::labels_near(const Eigen::AlignedBox3d& box) const {
  return labels_in(state_->cascade.shares(), state_->lattice.nodes_around(box));
}

void Background::local(std::span<const Eigen::Vector3d> points_mm, std::vector<float>& weight, PointShares& out) const {
  const BrickTable<NodeData>& data = state_->cascade.data();
  weight.assign(points_mm.size(), 0.0f);
  for_each_block(state_->lattice, points_mm, 0, [&](std::size_t first, NodeBlock& block) {
    block.clear();
    for_each_brick(data, block.bricks(),
                   [&](const Eigen::Vector3i& at, const NodeData& brick) { block.set(at, brick.weight); });
    block.interpolate(std::span(weight).subspan(first));
  });
  for (float& w : weight) w /= kWeightUnit;
  interpolate_labels(state_->lattice, data, points_mm, 1.0f / kWeightUnit, out);
  for (std::size_t l = 1; l < out.labels.size(); ++l)
    for (std::size_t i = 0; i < points_mm.size(); ++i) {
      float& share = out.share[l * points_mm.size() + i];
      share = weight[i] < kLeastWeight ? 0.0f : share / weight[i];
    }
  fill_outside(out, points_mm.size());
}

std::vector<BackgroundChange> Background::seeds() const {
  return state_->surface.all();
}

void Background::distance(std::span<const Eigen::Vector3d> points_mm, std::vector<float>& distance_mm) const {
  distance_mm.assign(points_mm.size(), 0.0f);
  distance_to_seen(state_->lattice, state_->cascade.data(), points_mm, kBackgroundReach, distance_mm);
  for (float& d : distance_mm) d *= static_cast<float>(state_->lattice.spacing_mm);
}

double Background::spacing_mm() const {
  return state_->lattice.spacing_mm;
}

Eigen::AlignedBox3d Background::cell_box(const Eigen::Vector3i& brick, int bit) const {
  const Eigen::Vector3i node = kBrickEdge * brick + Eigen::Vector3i(bit & 7, (bit >> 3) & 7, bit >> 6);
  const NodeLattice& l = state_->lattice;
  const auto stand = [&](double steps) {
    return l.origin_mm + l.spacing_mm * (node.cast<double>().array() + steps).matrix();
  };
  return {stand(0.5), stand(1.5)};
}

std::size_t Background::memory_bytes() const {
  return state_->cascade.memory_bytes();
}

}  // namespace sonoloft
