#pragma once
#include <vector>

#include "core/methods/straight_skeleton/patch/image.h"
#include "core/slice/section.h"

namespace sonoloft::skeleton {

/// What one slice knows: its contours, and the rim of the part that it saw. Where a contour ends at a rim, the slice's
/// grid left a point beside the rim by a step: it is put on it, so that rims have no bends that nobody drew.
class PatchMap {
 public:
  struct Edge {
    std::uint32_t a, b;  ///< spots
    Label left, right;
    FormPtr line;  ///< positive left
  };

  PatchMap(const Section& section, const Image& image);

  Image image;
  std::vector<Spot> spots;
  std::vector<Edge> edges;  ///< rims have an unknown side
  std::vector<std::vector<std::uint32_t>>
      rims;              ///< loops of spots, the known side left; straight from each to the next
  bool bounded = false;  ///< nothing is known far away

  /// The label of a point's foot. Where that lies on a contour: of the side that `towards` (of space) points to.
  [[nodiscard]] Label label_at(const Corner& p, const Eigen::Vector3d& towards) const;

  /// The labels left of a line, which lies within the patch or along its rim: spots where they change, and one label
  /// more than spots.
  struct Run {
    std::vector<Spot> changes;
    std::vector<Label> labels;
  };
  [[nodiscard]] Run labels_along(const Spot& a, const Spot& b) const;

 private:
  void find_rims(const Section& section);
  void straighten(std::vector<std::uint32_t>& loop, double tolerance_mm);
  Label border_;
  double doubt_mm_ = 0;
};

}  // namespace sonoloft::skeleton
