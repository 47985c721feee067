#pragma once
#include "core/methods/stack/layer_mesher.h"
#include "core/methods/stack/slice_stack.h"
#include "host/apps/measure/overlap.h"

namespace sonoloft::test {

/// Intersection over union of everything that a mesh and its truth enclose between the first and the last slice of a
/// stack, along 400 x 400 lines. Both: reference frame.
inline double covered_iou(const SliceStack& stack, const IndexedMesh& mesh, const IndexedMesh& truth) {
  const auto in_stack = [&](IndexedMesh of) {
    for (std::size_t t = 0; t < of.triangles.size(); ++t) {
      of.label_front[t] = kOutside;
      of.label_back[t] = 1;
    }
    return moved(std::move(of), stack.stack_to_reference.inverse(Eigen::Isometry));
  };
  const auto ticks = [](double low, double high) { return Ticks{low, (high - low) / 400, 400}; };
  const IndexedMesh ours = in_stack(mesh), theirs = in_stack(truth);
  const double margin_mm = 0.1 * stack.bounds.sizes().y();
  const ScanLines lines{{0, 0, 0},
                        ticks(stack.bounds.min().y() - margin_mm, stack.bounds.max().y() + margin_mm),
                        ticks(stack.heights_mm.front(), stack.heights_mm.back())};
  return scan_overlap({ours, &theirs, nullptr, {0, 0, 0}}, lines, 2).labels.front().iou();
}

}  // namespace sonoloft::test
