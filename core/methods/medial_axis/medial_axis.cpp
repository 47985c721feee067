#include "core/methods/medial_axis/medial_axis.h"

#include <algorithm>
#include <map>

#include "core/methods/medial_axis/arrangement.h"
#include "core/methods/medial_axis/sheet/cell_surface.h"
#include "core/methods/network/fairing/fairing.h"
#include "core/methods/network/fairing/refinement.h"
#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

using namespace medial;

/// Joins the surfaces of cells. What lies on slices has one name in all cells: its point of the network, or, where
/// three planes and more meet, the double next to its exact place.
class Joiner {
 public:
  explicit Joiner(const Arrangement& arranged)
      : network_(*arranged.network), points_(network_.points.size(), kNoPoint) {
    out_.surfaces.notes = arranged.notes;
  }

  /// Vertices on slices come first: once for all cells, before any add().
  void add_on_slices(const CellSurface& surface) {
    for (const std::uint32_t v : used(surface))
      if (surface.vertices[v].on_cell) on_slices(surface.vertices[v]);
    out_.surfaces.on_slices = out_.surfaces.positions.size();
  }
  void add(const CellSurface& surface, std::span<const Facing> faces) {
    std::vector<std::uint32_t> names(surface.vertices.size(), kNoPoint);
    for (const std::uint32_t v : used(surface)) {
      const CurveVertex& vertex = surface.vertices[v];
      names[v] = vertex.on_cell ? on_slices(vertex) : new_vertex(vertex.position);
    }
    for (const LabelledTriangle& t : surface.triangles) {
      const std::array corners{names[t.corners[0]], names[t.corners[1]], names[t.corners[2]]};
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
      out_.surfaces.triangles.push_back(corners);
      out_.surfaces.label_front.push_back(t.front);
      out_.surfaces.label_back.push_back(t.back);
      out_.cell_of.push_back(static_cast<std::uint32_t>(out_.walls.size()));
    }
    std::vector<Eigen::Hyperplane<double, 3>>& walls = out_.walls.emplace_back();
    for (const Facing& face : faces) {
      const Eigen::Isometry3d& frame = network_.planes[face.plane].frame;
      walls.emplace_back(face.side * frame.linear().col(2), frame.translation());
    }
  }
  JoinedCells done() { return std::move(out_); }

 private:
  static std::vector<std::uint32_t> used(const CellSurface& surface) {
    std::vector<std::uint32_t> all;
    for (const LabelledTriangle& t : surface.triangles) all.insert(all.end(), t.corners.begin(), t.corners.end());
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }
  std::uint32_t new_vertex(const Eigen::Vector3d& position) {
    out_.surfaces.positions.push_back(position);
    return static_cast<std::uint32_t>(out_.surfaces.positions.size() - 1);
  }
  std::uint32_t on_slices(const CurveVertex& vertex) {
    const bool inner = vertex.point != kNoPoint && network_.points[vertex.point].on.empty();
    const Eigen::Vector3d& p = vertex.position;
    std::uint32_t& name =
        inner ? points_[vertex.point] : places_.try_emplace({p.x(), p.y(), p.z()}, kNoPoint).first->second;
    if (name == kNoPoint) name = new_vertex(p);
    return name;
  }

  const CurveNetwork& network_;
  std::vector<std::uint32_t> points_;  ///< [#points] of the network
  std::map<std::array<double, 3>, std::uint32_t> places_;
  JoinedCells out_;
};

Result<MethodSurfaces> run(const MethodInput& input) {
  auto surfaces = medial_axis(input.slices, {input.settings.at("fairing") == "on", input.threads});
  if (!surfaces) return tl::unexpected<Error>(surfaces.error());
  return as_mesh(std::move(*surfaces));
}

}  // namespace

Result<ContourSurfaces> medial_axis(std::span<const TrackedSlice> slices, const MedialAxisOptions& options) {
  const auto arranged = arrange(slices);
  if (!arranged) return tl::unexpected<Error>(arranged.error());
  const std::vector<ContourCell>& cells = arranged->cells;
  std::vector<CellSurface> surfaces(cells.size());
  parallel_for(cells.size(), 1, options.threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t c = first; c < last; ++c)
      surfaces[c] = surface_of_cell(*arranged->network, cells[c].faces, cells[c].edges, arranged->scale_mm);
  });
  Joiner joiner(*arranged);
  for (const CellSurface& surface : surfaces) joiner.add_on_slices(surface);
  for (std::size_t c = 0; c < cells.size(); ++c) joiner.add(surfaces[c], cells[c].faces);
  JoinedCells joined = joiner.done();
  if (options.fairing) {
    refine(joined, 0);
    if (!fair(joined)) joined.surfaces.notes.emplace_back("the surfaces could not be made smooth");
  }
  return std::move(joined.surfaces);
}

Method medial_axis_method() {
  return {"medial-axis",
          "slices of any direction, one or many labels",
          {{"fairing", "whether the surfaces are made smooth between the slices", "on", {"on", "off"}}},
          run};
}

}  // namespace sonoloft
