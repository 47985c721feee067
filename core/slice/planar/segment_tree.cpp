#include "core/slice/planar/segment_tree.h"

#include <utility>

namespace sonoloft {
namespace {

/// Puts a zero bit before every bit.
std::uint64_t spread_bits(std::uint32_t v) {
  std::uint64_t x = v;
  x = (x | (x << 16)) & 0x0000FFFF0000FFFFull;
  x = (x | (x << 8)) & 0x00FF00FF00FF00FFull;
  x = (x | (x << 4)) & 0x0F0F0F0F0F0F0F0Full;
  x = (x | (x << 2)) & 0x3333333333333333ull;
  return (x | (x << 1)) & 0x5555555555555555ull;
}

std::uint64_t morton_key(const GridSegment& s) {
  const auto middle = [](std::int32_t p, std::int32_t q) {
    return static_cast<std::uint32_t>((std::int64_t{p} + q) / 2);
  };
  return spread_bits(middle(s.a.x, s.b.x)) | (spread_bits(middle(s.a.y, s.b.y)) << 1);
}

}  // namespace

SegmentTree::SegmentTree(const std::vector<GridSegment>& segments) {
  if (segments.empty()) return;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed(segments.size());
  for (std::uint32_t i = 0; i < keyed.size(); ++i) keyed[i] = {morton_key(segments[i]), i};
  std::sort(keyed.begin(), keyed.end());

  order_.resize(segments.size());
  Level level(segments.size());
  for (std::size_t k = 0; k < keyed.size(); ++k) {
    order_[k] = keyed[k].second;
    const GridSegment& s = segments[order_[k]];
    level[k] = {s.a.x, std::min(s.a.y, s.b.y), s.b.x, std::max(s.a.y, s.b.y)};
  }
  while (level.size() > 1) {
    Level above((level.size() + kFan - 1) / kFan);
    for (std::size_t k = 0; k < above.size(); ++k) {
      Box box = level[kFan * k];
      for (std::size_t c = kFan * k + 1; c < std::min<std::size_t>(kFan * (k + 1), level.size()); ++c)
        box = {std::min(box.x0, level[c].x0), std::min(box.y0, level[c].y0), std::max(box.x1, level[c].x1),
               std::max(box.y1, level[c].y1)};
      above[k] = box;
    }
    levels_.push_back(std::exchange(level, std::move(above)));
  }
  levels_.push_back(std::move(level));
}

}  // namespace sonoloft
