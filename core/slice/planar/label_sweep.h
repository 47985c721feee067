#pragma once
// make_section, step 2 of 2:  split_at_crossings -> [SWEEP] -> a label on both sides of every segment -> Section
#include <cstdint>
#include <vector>

#include "core/slice/label.h"
#include "core/slice/planar/planar_network.h"

namespace sonoloft {

/// What a contour says about the region it encloses.
struct Enclosure {
  Label label;  ///< kOutside of a hole
  bool hole;
};

struct LabelledEdge {
  std::uint32_t a, b;  ///< indices into LabelledNetwork::points, a < b
  Label above, below;  ///< left and right of a -> b
};

struct LabelledNetwork {
  std::vector<GridPoint> points;    ///< ascending
  std::vector<LabelledEdge> edges;  ///< ascending by a, then from right to left around a
};

/// Labels both sides of every segment by the rule of TrackedSlice: the smallest enclosing contour by its even-odd area;
/// of equal areas one that is no hole; of equals of a kind the first. Owner number enclosures.size() is the field of
/// view: what it does not enclose is unknown; pass has_view = false when there is none.
/// @pre   segments as left by split_at_crossings(), owners at most enclosures.size()
/// @cost  O(#S log #S) and log2(#owners) steps for every segment and owner
[[nodiscard]] LabelledNetwork label_sweep(const std::vector<OwnedSegment>& segments,
                                          const std::vector<Enclosure>& enclosures, bool has_view);

}  // namespace sonoloft
