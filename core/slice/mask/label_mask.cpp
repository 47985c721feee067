#include "core/slice/mask/label_mask.h"

#include <array>
#include <cassert>
#include <utility>

#include "core/slice/mask/mask_net.h"

namespace sonoloft {
namespace {

using mask::kNoVertex;
using mask::MaskNet;

constexpr double kThinning = 0.05;  // pixels

// Walks around every region, keeping it on the left.
class LoopWalker {
 public:
  LoopWalker(const MaskNet& net, std::vector<char> needed)
      : net_(net), needed_(std::move(needed)), walked_(net.vertices.size()) {}

  MaskContours walk() {
    for (std::uint32_t v = 0; v < net_.vertices.size(); ++v) {
      for (std::uint8_t d = 0; d < 4; ++d) {
        if (net_.vertices[v].to[d] != kNoVertex && !walked_[v][d]) walk_around(v, d);
      }
    }
    return std::move(found_);
  }

 private:
  void walk_around(std::uint32_t v, std::uint8_t direction) {
    const Label label = net_.vertices[v].label_left[direction];
    const std::size_t first = found_.points.size();
    std::int64_t twice_area = 0;  // of the corners; rows go down, so that an outer border has a negative one
    while (!walked_[v][direction]) {
      walked_[v][direction] = true;
      if (needed_[v] != 0) found_.points.push_back(net_.position[v]);
      const MaskNet::Vertex& from = net_.vertices[v];
      v = from.to[direction];
      const MaskNet::Vertex& to = net_.vertices[v];
      twice_area += std::int64_t{from.x} * to.y - std::int64_t{to.x} * from.y;
      direction = leave(to, direction);
    }
    const auto count = found_.points.size() - first;
    // The inner border of a region is the outer one of what it encloses, or nothing that needs a loop.
    if (twice_area > 0 || count < 3) return found_.points.resize(first);
    found_.contours.push_back(
        {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count), label, label == kOutside});
  }

  // The leftmost way on: regions that meet in a corner only stay apart.
  static std::uint8_t leave(const MaskNet::Vertex& vertex, std::uint8_t direction) {
    for (const int turn : {3, 0, 1}) {
      const auto d = static_cast<std::uint8_t>((direction + turn) % 4);
      if (vertex.to[d] != kNoVertex) return d;
    }
    assert(false);
    return direction;
  }

  const MaskNet& net_;
  const std::vector<char> needed_;
  std::vector<std::array<bool, 4>> walked_;  ///< [#V] by direction
  MaskContours found_;
};

}  // namespace

MaskContours trace_mask(const LabelMask& mask) {
  assert(mask.labels.size() == static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height));
  MaskNet net = mask::make_net(mask);
  mask::smooth(net);
  return LoopWalker(net, mask::needed_vertices(net, kThinning)).walk();
}

}  // namespace sonoloft
