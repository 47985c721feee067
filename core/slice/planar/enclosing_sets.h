#pragma once
// Which contours enclose a region: small numbers for sets of contours, for label_sweep.
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace sonoloft {

/// Sets of the members 0..count-1; equal sets have equal numbers. A set that differs from one already known in one
/// member takes log2(count) new nodes at most: a thousand nested contours do not make a thousand lists of contours.
class EnclosingSets {
 public:
  using Set = std::uint32_t;
  static constexpr Set kEmpty = 0;
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  /// @pre count >= 1
  explicit EnclosingSets(std::uint32_t count);

  /// The set with `member` put in, or taken out where it was in. O(log count)
  [[nodiscard]] Set toggled(Set set, std::uint32_t member) { return toggled(set, member, depth_); }
  /// O(log count)
  [[nodiscard]] bool contains(Set set, std::uint32_t member) const;

  /// For every set, by its number: the member with the lowest rank; kNone for kEmpty (and for other unused numbers).
  /// @param rank [#members] no two equal
  [[nodiscard]] std::vector<std::uint32_t> lowest(std::span<const std::uint32_t> rank) const;

 private:
  struct Children {
    Set zero, one;  ///< the parts of the set whose members have this bit clear, and set
  };
  Set toggled(Set set, std::uint32_t member, std::uint32_t depth);
  /// Numbers: 0 the empty set, 1 + m the set of m alone (at depth 0), then the inner nodes.
  Children children(Set set) const { return set == kEmpty ? Children{} : nodes_[set - first_node_]; }

  std::uint32_t depth_;  ///< bits of a member
  Set first_node_;
  std::vector<Children> nodes_;
  std::unordered_map<std::uint64_t, Set> known_;  ///< by both children
};

}  // namespace sonoloft
