#pragma once
#include <cstdint>

#include "core/cells/cell_store.h"

namespace sonoloft {

/// See CellComplex::withdraw(). The cell that the slice cut first is made anew: the planes on the way to it cut it out
/// of the box once more, and the slices of these planes label its walls.
[[nodiscard]] CellComplex::Withdrawal withdraw(CellStore& store, std::uint32_t slice);

/// See CellComplex::insert_again().
[[nodiscard]] CellComplex::Delta insert_again(CellStore& store, std::uint32_t slice,
                                              const CellComplex::Withdrawal& where,
                                              const CellComplex::PartWidth& width);

}  // namespace sonoloft
