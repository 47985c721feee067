#include "core/methods/stack/layer_mesher.h"

#include <algorithm>
#include <cmath>

#include "core/mesh/surface_extractor.h"
#include "core/methods/stack/brick_lattice.h"
#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

constexpr double kMaxSamples = 1 << 30, kMaxSide = 1 << 17;
/// Layers of a row of bricks, and one more on both sides.
constexpr int kWindow = kBrickSize + 2;
/// A label's share is 1/2 on its surface and 0 and 1 so many finest cells away.
constexpr float kShareReach = 4;

/// Whole number of the brick that a lattice coordinate lies in.
int brick_of(int lattice) {
  return static_cast<int>(std::floor(static_cast<double>(lattice) / kBrickSize));
}

class Sampling {
 public:
  Sampling(const LayeredField& field, int threads)
      : field_(field),
        grid_(field.grid()),
        threads_(threads),
        lattice_(Eigen::Vector3d::Constant(0.5 * grid_.spacing_mm), grid_.spacing_mm),
        lowest_(level_below(field.lowest_mm()) - 1),
        highest_(level_below(field.highest_mm()) + 2) {
    for (Layer& layer : window_) {
      layer.value_mm.resize(field.labels().size() * grid_.size());
      layer.label.resize(grid_.size());
    }
  }

  BrickLattice run() {
    for (int row = brick_of(lowest_ - 1); row <= brick_of(highest_ + 1); ++row) {
      fill_window(kBrickSize * row - 1);
      add_bricks(row);
    }
    return std::move(lattice_);
  }

 private:
  struct Layer {
    std::vector<float> value_mm;  ///< [#labels][#nodes]
    std::vector<Label> label;     ///< [#nodes] that with the largest value
  };

  [[nodiscard]] int level_below(double height_mm) const {
    return static_cast<int>(std::floor(height_mm / grid_.spacing_mm - 0.5));
  }

  /// Layers first, first + 1, ...: the last two of the window before are its first two.
  void fill_window(int first) {
    const bool has_before = window_first_ == first - kBrickSize;
    if (has_before) std::rotate(window_.begin(), window_.begin() + kBrickSize, window_.end());
    window_first_ = first;
    const std::size_t kept = has_before ? kWindow - kBrickSize : 0;
    parallel_for(kWindow - kept, 1, threads_, [&](std::size_t from, std::size_t to) {
      for (std::size_t i = kept + from; i < kept + to; ++i) fill(window_[i], first + static_cast<int>(i));
    });
  }

  void fill(Layer& layer, int level) const {
    const std::size_t nodes = grid_.size();
    const std::vector<Label>& labels = field_.labels();
    std::ranges::fill(layer.label, kOutside);
    if (level < lowest_ || level > highest_) return;
    field_.layer(grid_.spacing_mm * (level + 0.5), layer.value_mm);
    for (int y = 1; y + 1 < grid_.height; ++y)
      for (int x = 1; x + 1 < grid_.width; ++x) {
        const std::size_t node = grid_.index(x, y);
        std::size_t best = 0;
        for (std::size_t l = 1; l < labels.size(); ++l)
          if (layer.value_mm[l * nodes + node] > layer.value_mm[best * nodes + node]) best = l;
        layer.label[node] = labels[best];
      }
  }

  void add_bricks(int row) {
    const Eigen::Vector2i low = grid_.first, high = grid_.first + Eigen::Vector2i(grid_.width - 1, grid_.height - 1);
    for (int by = brick_of(low.y() - 1); by <= brick_of(high.y() + 1); ++by)
      for (int bx = brick_of(low.x() - 1); bx <= brick_of(high.x() + 1); ++bx)
        if (const BrickCoord coord{bx, by, row}; has_surface(coord)) lattice_.add(brick_at(coord));
  }

  /// Index of the node at lattice coordinates, or #nodes beyond the grid.
  [[nodiscard]] std::size_t node_at(int x, int y) const {
    const Eigen::Vector2i at = Eigen::Vector2i(x, y) - grid_.first;
    return at.minCoeff() < 0 || at.x() >= grid_.width || at.y() >= grid_.height ? grid_.size()
                                                                                : grid_.index(at.x(), at.y());
  }

  /// Whether the samples of a brick and one more on every side differ in label: all corners of cells beside a lattice
  /// edge of two labels lie in such bricks.
  [[nodiscard]] bool has_surface(const BrickCoord& coord) const {
    Label first = kNotSampled;
    for (const Layer& layer : window_)
      for (int y = -1; y <= kBrickSize; ++y)
        for (int x = -1; x <= kBrickSize; ++x) {
          const std::size_t node = node_at(kBrickSize * coord.x + x, kBrickSize * coord.y + y);
          const Label label = node == grid_.size() ? kOutside : layer.label[node];
          if (first == kNotSampled) first = label;
          if (label != first) return true;
        }
    return false;
  }

  [[nodiscard]] std::unique_ptr<Brick> brick_at(const BrickCoord& coord) const {
    auto brick = std::make_unique<Brick>();
    brick->coord = coord;
    brick->palette = field_.labels();
    brick->share.assign(brick->palette.size() * kBrickSamples, 0);
    for (int i = 0; i < kBrickSamples; ++i) {
      const int x = i % kBrickSize, y = i / kBrickSize % kBrickSize, z = i / (kBrickSize * kBrickSize);
      const Layer& layer = window_[static_cast<std::size_t>(z + 1)];
      const std::size_t node = node_at(kBrickSize * coord.x + x, kBrickSize * coord.y + y);
      const auto sample = static_cast<std::size_t>(i);
      brick->label[sample] = node == grid_.size() ? kOutside : layer.label[node];
      for (std::size_t l = 0; l < brick->palette.size(); ++l)
        brick->share[l * kBrickSamples + sample] = share_at(layer, l, node, window_first_ + z + 1);
    }
    return brick;
  }

  [[nodiscard]] float share_at(const Layer& layer, std::size_t label, std::size_t node, int level) const {
    if (node == grid_.size() || level < lowest_ || level > highest_) return label == 0 ? 1.0F : 0.0F;
    const float cells = layer.value_mm[label * grid_.size() + node] / static_cast<float>(grid_.spacing_mm);
    return std::clamp(0.5F + 0.5F * cells / kShareReach, 0.0F, 1.0F);
  }

  const LayeredField& field_;
  const PlaneGrid& grid_;
  int threads_;
  BrickLattice lattice_;
  int lowest_, highest_;  ///< levels that are asked; beyond them all is outside
  std::array<Layer, kWindow> window_;
  int window_first_ = std::numeric_limits<int>::min() / 2;
};

}  // namespace

Result<void> check_size(const Eigen::Vector3d& sizes_mm, double spacing_mm, std::size_t slices) {
  constexpr double kAround = 20;  // samples on all sides, and the next slice of a stack
  const Eigen::Array3d sides = sizes_mm.array() / spacing_mm + kAround;
  const double layers = std::max(sides.z(), static_cast<double>(slices));
  if (sides.maxCoeff() <= kMaxSide && sides.x() * sides.y() * layers <= kMaxSamples) return {};
  return fail(ErrorCode::too_large,
              "the slices reach over 2^17 finest cells in a row, or 2^30 in all: give a smaller --depth");
}

Result<IndexedMesh> mesh_of(const LayeredField& field, std::span<const Section> slices, int threads) {
  BrickLattice lattice = Sampling(field, threads).run();
  for (std::size_t i = 0; i < slices.size(); ++i) lattice.add_contours(slices[i], static_cast<SliceId>(i));
  SurfaceExtractor extractor;
  extractor.update(lattice, lattice.bricks(), threads);
  IndexedMesh mesh = extractor.snapshot().indexed();
  if (mesh.triangles.empty())
    return fail(ErrorCode::empty_input, "the slices bound nothing that is a cell wide: give a larger --depth");
  return mesh;
}

IndexedMesh moved(IndexedMesh mesh, const Eigen::Isometry3d& to) {
  for (Eigen::Vector3f& p : mesh.positions) p = (to * p.cast<double>()).cast<float>();
  return mesh;
}

}  // namespace sonoloft
