#include "core/completion/cell_groups.h"

#include <algorithm>
#include <utility>

namespace sonoloft {
namespace {

std::size_t index(CellId cell) {
  return static_cast<std::uint32_t>(cell);
}

}  // namespace

void CellGroups::join(CellId a, CellId b) {
  if (a == b) return;
  joined_[index(a)].push_back(b);
  joined_[index(b)].push_back(a);
}

void CellGroups::finish() {
  for (std::vector<CellId>& cells : joined_) {
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  }
  constexpr CellId kNone{0xFFFFFFFF};
  lowest_.assign(joined_.size(), kNone);
  std::vector<CellId> waiting;
  for (std::uint32_t first = 0; first < joined_.size(); ++first) {
    if (lowest_[first] != kNone) continue;
    lowest_[first] = CellId{first};
    for (waiting.push_back(CellId{first}); !waiting.empty();) {
      const CellId cell = waiting.back();
      waiting.pop_back();
      for (const CellId other : joined_[index(cell)])
        if (std::exchange(lowest_[index(other)], CellId{first}) == kNone) waiting.push_back(other);
    }
  }
}

std::pair<CellId, CellId> CellGroups::key(CellId a, CellId b, std::optional<int> hops) const {
  if (hops) return std::minmax(a, b);
  return std::minmax(lowest_[index(a)], lowest_[index(b)]);
}

std::vector<CellId> CellGroups::group(const std::pair<CellId, CellId>& key, std::optional<int> hops) const {
  std::vector<CellId> cells{key.first, key.second};
  std::vector<bool> seen(joined_.size(), false);
  seen[index(key.first)] = seen[index(key.second)] = true;
  if (key.first == key.second) cells.pop_back();
  std::size_t next = 0;
  for (int hop = 1; next < cells.size() && (!hops || hop < *hops); ++hop)
    for (const std::size_t end = cells.size(); next < end; ++next)
      for (const CellId other : joined_[index(cells[next])])
        if (!seen[index(other)]) {
          seen[index(other)] = true;
          cells.push_back(other);
        }
  std::sort(cells.begin(), cells.end());
  return cells;
}

}  // namespace sonoloft
