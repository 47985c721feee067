#include "core/cells/slice_walk.h"

#include <algorithm>
#include <utility>

namespace sonoloft {

FacePolygon whole_section(const CellStore& store, const Section& section, CellComplex::Work& work) {
  const Eigen::Isometry3d reference_to_image = section.image_to_reference.inverse();
  Eigen::AlignedBox2d extent;
  for (int i = 0; i < 8; ++i)
    extent.extend((reference_to_image * store.box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i))).head<2>());
  for (const Eigen::Vector2d& p : section.points) extent.extend(p);
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(0.01 * extent.diagonal().norm());
  FacePolygon polygon = rectangle({extent.min() - margin, extent.max() + margin}, section.border);
  polygon.reserve(polygon.size() + section.edges.size());
  for (std::uint32_t i = 0; i < section.edges.size(); ++i) {
    const SectionEdge& e = section.edges[i];
    polygon.push_back({section.points[e.a], section.points[e.b], e.left, e.right, i});
  }
  for (std::uint32_t wall = 0; wall < kBoxWalls; ++wall) {
    ImageLine line;
    if (store.line_on(wall, section.image_to_reference, line)) {
      work.edges_clipped += static_cast<std::uint32_t>(polygon.size());
      polygon = split(polygon, line).second;
    } else if (line.offset_mm < 0.0) {
      return {};
    }
  }
  return polygon;
}

bool has_known_part(const FacePolygon& polygon) {
  return std::any_of(polygon.begin(), polygon.end(), [](const FaceEdge& e) {
    return e.left != kUnknown || (e.right != kUnknown && e.right != kBeyondFace);
  });
}

std::array<FacePolygon, 2> parts_at(const CellStore& store, std::uint32_t plane, const Eigen::Isometry3d& frame,
                                    FacePolygon polygon, CellComplex::Work& work) {
  ImageLine line;
  const bool crosses = store.line_on(plane, frame, line);
  bool below = line.offset_mm < 0.0;
  bool above = !below;
  if (crosses) {
    below = above = false;
    for (const FaceEdge& e : polygon) (line.distance(e.a) < 0.0 ? below : above) = true;
  }
  if (below && above) {
    work.edges_clipped += static_cast<std::uint32_t>(polygon.size());
    auto [lower, upper] = split(polygon, line);
    return {std::move(lower), std::move(upper)};
  }
  std::array<FacePolygon, 2> parts;
  parts[above ? 1 : 0] = std::move(polygon);
  return parts;
}

std::vector<Arrival> walk(const CellStore& store, const Eigen::Isometry3d& frame, std::vector<Fragment> stack,
                          CellComplex::Work& work) {
  std::vector<Arrival> reached;
  while (!stack.empty()) {
    Fragment fragment = std::move(stack.back());
    stack.pop_back();
    if (!has_known_part(fragment.polygon)) continue;
    if (fragment.node < 0) {
      reached.push_back({CellId{static_cast<std::uint32_t>(~fragment.node)}, std::move(fragment.polygon)});
      continue;
    }
    ++work.nodes_visited;
    const TreeNode& node = store.nodes[static_cast<std::size_t>(fragment.node)];
    auto parts = parts_at(store, node.plane, frame, std::move(fragment.polygon), work);
    for (const std::size_t upper : {std::size_t{0}, std::size_t{1}})
      if (!parts[upper].empty()) stack.push_back({node.child[upper], std::move(parts[upper])});
  }
  std::sort(reached.begin(), reached.end(), [](const Arrival& l, const Arrival& r) { return l.cell < r.cell; });
  return reached;
}

}  // namespace sonoloft
