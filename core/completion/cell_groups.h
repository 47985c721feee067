#pragma once
// cells, unknown parts of walls -> [GROUPS] -> the cells whose walls a corner is completed from
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/cells/cell_complex.h"

namespace sonoloft {

/// Cells that are joined through unknown parts of walls.
class CellGroups {
 public:
  explicit CellGroups(std::size_t cell_bound) : joined_(cell_bound) {}

  void join(CellId a, CellId b);
  /// After the last join(), before the rest. @cost O(joints log joints)
  void finish();

  /// What corners with cells a and b on both sides have in common: the same key, the same group().
  [[nodiscard]] std::pair<CellId, CellId> key(CellId a, CellId b, std::optional<int> hops) const;
  /// Ascending: a, b and what is joined to them over up to `hops` - 1 cells; without `hops` over any number.
  [[nodiscard]] std::vector<CellId> group(const std::pair<CellId, CellId>& key, std::optional<int> hops) const;

 private:
  std::vector<std::vector<CellId>> joined_;  ///< [cell]
  std::vector<CellId> lowest_;               ///< [cell] of all that are joined to it
};

}  // namespace sonoloft
