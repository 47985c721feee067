#include "core/slice/planar/enclosing_sets.h"

#include <bit>
#include <cassert>

namespace sonoloft {

EnclosingSets::EnclosingSets(std::uint32_t count)
    : depth_(static_cast<std::uint32_t>(std::bit_width(count - 1))), first_node_(count + 1) {
  assert(count >= 1);
}

EnclosingSets::Set EnclosingSets::toggled(Set set, std::uint32_t member, std::uint32_t depth) {
  if (depth == 0) return set == kEmpty ? 1 + member : kEmpty;
  Children c = children(set);
  Set& side = (member >> (depth - 1)) & 1 ? c.one : c.zero;
  side = toggled(side, member, depth - 1);
  if (c.zero == kEmpty && c.one == kEmpty) return kEmpty;
  const auto [entry, is_new] =
      known_.try_emplace((std::uint64_t{c.zero} << 32) | c.one, first_node_ + static_cast<Set>(nodes_.size()));
  if (is_new) nodes_.push_back(c);
  return entry->second;
}

bool EnclosingSets::contains(Set set, std::uint32_t member) const {
  for (std::uint32_t depth = depth_; depth > 0 && set != kEmpty; --depth) {
    const Children c = children(set);
    set = (member >> (depth - 1)) & 1 ? c.one : c.zero;
  }
  return set != kEmpty;
}

std::vector<std::uint32_t> EnclosingSets::lowest(std::span<const std::uint32_t> rank) const {
  assert(rank.size() + 1 == first_node_);
  std::vector<std::uint32_t> best{kNone};
  best.reserve(first_node_ + nodes_.size());
  for (std::uint32_t m = 0; m < rank.size(); ++m) best.push_back(m);
  for (const Children& c : nodes_) {  // children come before their parents
    const std::uint32_t p = best[c.zero], q = best[c.one];
    best.push_back(q == kNone || (p != kNone && rank[p] < rank[q]) ? p : q);
  }
  return best;
}

}  // namespace sonoloft
