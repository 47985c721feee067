#include "core/slopes/contour/border_tree.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "core/slice/four.h"

namespace sonoloft {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

Four greater(Four a, Four b) {
  return a > b ? a : b;
}

}  // namespace

struct BorderTree::Search {
  float x, y;
  std::uint32_t labels;  ///< bits
  std::optional<Label> label;
  float best2, facing2 = -1;
  const Block* block = nullptr;
  bool on_left = false;
};

BorderTree::BorderTree(const Section& section, const Arcs& arcs) {
  if (section.points.empty()) return;
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& p : section.points) box.extend(p);
  origin_ = box.center();
  extent_mm_ = box.sizes().maxCoeff();
  for (const Arc& arc : arcs.arcs)
    for (std::uint32_t place = arc.first; place < arc.end() && arc.has_edge(place); place += kFan)
      add_block(section, arcs, arc, place);
  add_levels();
}

void BorderTree::add_block(const Section& section, const Arcs& arcs, const Arc& arc, std::uint32_t first) {
  const std::uint32_t end = arc.closed ? arc.end() : arc.end() - 1;
  Block block;
  block.first = first;
  block.count = std::min(kFan, end - first);
  block.left = arc.left;
  block.right = arc.right;
  for (std::uint32_t i = 0; i < kFan; ++i) {
    const std::uint32_t place = first + std::min(i, block.count - 1);
    const Eigen::Vector2f a = (section.points[arcs.point[place]] - origin_).cast<float>();
    const Eigen::Vector2f b = (section.points[arcs.point[arc.next(place)]] - origin_).cast<float>();
    block.ax[i] = a.x();
    block.ay[i] = a.y();
    block.bx[i] = b.x();
    block.by[i] = b.y();
    block.inverse_length2[i] = 1.0f / std::max((b - a).squaredNorm(), std::numeric_limits<float>::min());
  }
  blocks_.push_back(block);
}

void BorderTree::add_levels() {
  constexpr Boxes kNone = [] {
    Boxes none{};
    none.x0.fill(kInfinity);
    none.y0.fill(kInfinity);
    none.x1.fill(kInfinity);
    none.y1.fill(kInfinity);
    return none;
  }();
  const auto minimum = [](const Lanes& v) { return *std::min_element(v.begin(), v.end()); };
  const auto maximum = [](const Lanes& v) {
    float greatest = -kInfinity;
    for (const float x : v)
      if (x != kInfinity) greatest = std::max(greatest, x);
    return greatest;
  };
  const auto box_of = [&](std::size_t i, Boxes& boxes, std::size_t lane) {
    if (levels_.empty()) {
      const Block& b = blocks_[i];
      boxes.x0[lane] = std::min(minimum(b.ax), minimum(b.bx));
      boxes.y0[lane] = std::min(minimum(b.ay), minimum(b.by));
      boxes.x1[lane] = std::max(maximum(b.ax), maximum(b.bx));
      boxes.y1[lane] = std::max(maximum(b.ay), maximum(b.by));
      boxes.labels[lane] = label_bit(b.left) | label_bit(b.right);
    } else {
      const Boxes& b = levels_.back()[i];
      boxes.x0[lane] = minimum(b.x0);
      boxes.y0[lane] = minimum(b.y0);
      boxes.x1[lane] = maximum(b.x1);
      boxes.y1[lane] = maximum(b.y1);
      for (const std::uint32_t labels : b.labels) boxes.labels[lane] |= labels;
    }
  };
  for (std::size_t count = blocks_.size(); levels_.empty() || count > 1;) {
    std::vector<Boxes> level((count + kFan - 1) / kFan, kNone);
    for (std::size_t i = 0; i < count; ++i) box_of(i, level[i / kFan], i % kFan);
    count = level.size();
    levels_.push_back(std::move(level));
  }
}

void BorderTree::look_at(const Block& block, Search& search) const {
  if (search.label && block.left != *search.label && block.right != *search.label) return;
  Lanes distance2, cross;
  for (std::size_t i = 0; i < kFan; i += kFour) {
    const Four ax = load_four(&block.ax[i]), ay = load_four(&block.ay[i]), bx = load_four(&block.bx[i]),
               by = load_four(&block.by[i]);
    const Four ex = bx - ax, ey = by - ay, px = search.x - ax, py = search.y - ay;
    const Four t = (px * ex + py * ey) * load_four(&block.inverse_length2[i]);
    const Four inner = greater(t, Four{});
    // Beyond the end the same subtraction as from the next edge's start, so that both are equally far.
    const Four rx = t < 1.0f ? px - inner * ex : search.x - bx;
    const Four ry = t < 1.0f ? py - inner * ey : search.y - by;
    store_four(rx * rx + ry * ry, &distance2[i]);
    store_four(ex * py - ey * px, &cross[i]);
  }
  for (std::uint32_t i = 0; i < kFan; ++i) {
    if (distance2[i] > search.best2) continue;
    const float facing2 = cross[i] * cross[i] * block.inverse_length2[i];
    if (distance2[i] == search.best2 && facing2 <= search.facing2) continue;
    search.best2 = distance2[i];
    search.facing2 = facing2;
    search.block = &block;
    search.on_left = cross[i] > 0;
  }
}

void BorderTree::descend(std::size_t level, std::uint32_t node, Search& search) const {
  const Boxes& boxes = levels_[level][node];
  Lanes distance2;
  for (std::size_t i = 0; i < kFan; i += kFour) {
    const Four x = greater(greater(load_four(&boxes.x0[i]) - search.x, search.x - load_four(&boxes.x1[i])), Four{});
    const Four y = greater(greater(load_four(&boxes.y0[i]) - search.y, search.y - load_four(&boxes.y1[i])), Four{});
    store_four(x * x + y * y, &distance2[i]);
  }
  for (std::uint32_t i = 0; i < kFan; ++i) {
    if (distance2[i] > search.best2 || (boxes.labels[i] & search.labels) == 0) continue;
    const std::uint32_t child = kFan * node + i;
    if (level > 0)
      descend(level - 1, child, search);
    else if (&blocks_[child] != search.block)
      look_at(blocks_[child], search);
  }
}

std::optional<BorderTree::Nearest> BorderTree::nearest(const Eigen::Vector2d& point_mm, double reach_mm,
                                                       std::optional<Label> label, std::uint32_t hint) const {
  if (empty()) return std::nullopt;
  const Eigen::Vector2f p = (point_mm - origin_).cast<float>();
  const auto reach = static_cast<float>(reach_mm);
  Search search{p.x(), p.y(), label ? label_bit(*label) : ~0u, label, reach * reach};
  look_at(blocks_[hint], search);
  descend(levels_.size() - 1, 0, search);
  if (search.block == nullptr) return std::nullopt;
  const Block& block = *search.block;
  return Nearest{std::sqrt(search.best2), search.on_left ? block.left : block.right, block.left, block.right,
                 static_cast<std::uint32_t>(search.block - blocks_.data())};
}

}  // namespace sonoloft
