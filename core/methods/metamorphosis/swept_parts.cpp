#include "core/methods/metamorphosis/swept_parts.h"

#include <array>

namespace sonoloft {
namespace {

class Collector {
 public:
  Collector(const PlaneGrid& grid, const SlicePair& slices)
      : slices_(slices),
        steps_{-1, 1, -std::ptrdiff_t{grid.width}, std::ptrdiff_t{grid.width}},
        part_of_(grid.size(), kNotSwept) {}

  SweptParts run() {
    SweptParts found;
    for (std::size_t node = 0; node < part_of_.size(); ++node)
      if (slices_.swept(node) && part_of_[node] == kNotSwept)
        found.parts.push_back(part_from(node, static_cast<std::uint32_t>(found.parts.size())));
    found.part_of = std::move(part_of_);
    return found;
  }

 private:
  SweptPart part_from(std::size_t first, std::uint32_t number) {
    SweptPart part;
    part.in_lower = slices_.in_lower(first);
    part_of_[first] = number;
    part.nodes.push_back(static_cast<std::uint32_t>(first));
    for (std::size_t i = 0; i < part.nodes.size(); ++i) {
      bool on_lower = false, on_upper = false;
      for (const std::ptrdiff_t step : steps_) {
        const auto beside = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(part.nodes[i]) + step);
        const bool swept = slices_.swept(beside), same = slices_.in_lower(beside) == part.in_lower;
        if (swept && same && part_of_[beside] == kNotSwept) {
          part_of_[beside] = number;
          part.nodes.push_back(static_cast<std::uint32_t>(beside));
        }
        on_lower |= !swept && !same;
        on_upper |= !swept && same;
      }
      part.on_lower += on_lower;
      part.on_upper += on_upper;
    }
    return part;
  }

  const SlicePair& slices_;
  std::array<std::ptrdiff_t, 4> steps_;  ///< to the nodes beside
  std::vector<std::uint32_t> part_of_;
};

}  // namespace

SweptParts swept_parts(const PlaneGrid& grid, const SlicePair& slices) {
  return Collector(grid, slices).run();
}

}  // namespace sonoloft
