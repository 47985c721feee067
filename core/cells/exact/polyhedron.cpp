#include "core/cells/exact/polyhedron.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <utility>

namespace sonoloft {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF;

/// Collects the polyhedron that `part` builds: old vertices get new numbers when first used.
class PartBuilder {
 public:
  PartBuilder(const Polyhedron& whole, std::span<const Plane> planes, std::uint32_t cut, double scale)
      : whole_(whole), planes_(planes), cut_(cut), scale_(scale), renumbered_(whole.vertices.size(), kNone) {}

  std::uint32_t keep(std::uint32_t old) {
    if (renumbered_[old] == kNone) {
      renumbered_[old] = static_cast<std::uint32_t>(result.vertices.size());
      result.vertices.push_back(whole_.vertices[old]);
    }
    return renumbered_[old];
  }

  /// The vertex where the cut meets the edge between old vertices a and b, an edge of the face on `plane`.
  std::uint32_t cross(std::uint32_t a, std::uint32_t b, std::uint32_t plane) {
    const auto key = std::minmax(a, b);
    for (CutEdge& e : cut_edges_)
      if (e.a == key.first && e.b == key.second) {
        place(e, plane);
        return e.vertex;
      }
    const auto vertex = static_cast<std::uint32_t>(result.vertices.size());
    result.vertices.emplace_back();
    cut_edges_.push_back({key.first, key.second, plane, vertex});
    return vertex;
  }

  Polyhedron result;

 private:
  struct CutEdge {
    std::uint32_t a, b, plane, vertex;
  };

  /// Both faces of the edge are known now. Planes are met in ascending order, so that the same corner of the complex
  /// gets the same bits in every cell.
  void place(const CutEdge& e, std::uint32_t other_plane) {
    std::array<std::uint32_t, 3> ids{e.plane, other_plane, cut_};
    std::sort(ids.begin(), ids.end());
    result.vertices[e.vertex] = {meet(planes_[ids[0]], planes_[ids[1]], planes_[ids[2]], scale_), ids};
  }

  const Polyhedron& whole_;
  std::span<const Plane> planes_;
  std::uint32_t cut_;
  double scale_;
  std::vector<std::uint32_t> renumbered_;
  std::vector<CutEdge> cut_edges_;
};

/// The face on the cut: the edges that the other faces leave open, turned round and joined.
void add_cap(Polyhedron& p, std::uint32_t cut, bool above,
             const std::vector<std::pair<std::uint32_t, std::uint32_t>>& open) {
  assert(open.size() >= 3);
  PolyFace face{cut, static_cast<std::uint32_t>(p.loops.size()), static_cast<std::uint32_t>(open.size()), kNone, above};
  std::uint32_t vertex = open.front().second;
  for (std::size_t i = 0; i < open.size(); ++i) {
    p.loops.push_back(vertex);
    const auto next = std::find_if(open.begin(), open.end(), [&](const auto& e) { return e.second == vertex; });
    assert(next != open.end());
    vertex = next->first;
  }
  assert(vertex == open.front().second);
  p.faces.push_back(face);
}

}  // namespace

Polyhedron make_box(std::span<const Plane> planes, double scale) {
  Polyhedron box;
  for (std::uint32_t i = 0; i < 8; ++i) {
    const std::array<std::uint32_t, 3> ids{i & 1u, 2u + ((i >> 1) & 1u), 4u + ((i >> 2) & 1u)};
    box.vertices.push_back({meet(planes[ids[0]], planes[ids[1]], planes[ids[2]], scale), ids});
  }
  // Counter-clockwise from outside; vertex i has bit 0 for x+, bit 1 for y+, bit 2 for z+.
  constexpr std::uint32_t kLoops[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (std::uint32_t f = 0; f < 6; ++f) {
    box.faces.push_back({f, 4 * f, 4, kNone, true});
    box.loops.insert(box.loops.end(), std::begin(kLoops[f]), std::end(kLoops[f]));
  }
  return box;
}

Polyhedron part(const Polyhedron& whole, std::span<const std::int8_t> side, int keep, std::span<const Plane> planes,
                std::uint32_t cut, double scale) {
  PartBuilder builder(whole, planes, cut, scale);
  Polyhedron& result = builder.result;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> open;
  std::vector<std::pair<std::uint32_t, bool>> loop;  // vertex, on the cut
  for (const PolyFace& face : whole.faces) {
    const std::span<const std::uint32_t> old(&whole.loops[face.first], face.count);
    const auto kept = [&](std::uint32_t v) { return side[v] == keep; };
    if (std::none_of(old.begin(), old.end(), kept)) continue;
    loop.clear();
    for (std::size_t i = 0; i < old.size(); ++i) {
      const std::uint32_t a = old[i];
      const std::uint32_t b = old[(i + 1) % old.size()];
      if (side[a] == keep || side[a] == 0) loop.emplace_back(builder.keep(a), side[a] == 0);
      if (side[a] * side[b] < 0) loop.emplace_back(builder.cross(a, b, face.plane), true);
    }
    PolyFace copy = face;
    copy.first = static_cast<std::uint32_t>(result.loops.size());
    copy.count = static_cast<std::uint32_t>(loop.size());
    for (std::size_t i = 0; i < loop.size(); ++i) {
      result.loops.push_back(loop[i].first);
      const auto& next = loop[(i + 1) % loop.size()];
      if (loop[i].second && next.second) open.emplace_back(loop[i].first, next.first);
    }
    result.faces.push_back(copy);
  }
  add_cap(result, cut, keep > 0, open);
  return std::move(builder.result);
}

Eigen::Vector3d centre(const Polyhedron& p) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const PolyVertex& v : p.vertices) sum += v.position;
  return sum / static_cast<double>(p.vertices.size());
}

double volume(const Polyhedron& p) {
  const Eigen::Vector3d c = centre(p);
  double six = 0.0;
  for (const PolyFace& face : p.faces) {
    const auto at = [&](std::uint32_t i) -> Eigen::Vector3d {
      return p.vertices[p.loops[face.first + i]].position - c;
    };
    for (std::uint32_t i = 1; i + 1 < face.count; ++i) six += at(0).dot(at(i).cross(at(i + 1)));
  }
  return six / 6.0;
}

std::string validate(const Polyhedron& p, std::span<const Plane> planes, double tolerance_mm) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed;
  for (const PolyFace& face : p.faces) {
    if (face.count < 3) return "a face with fewer than 3 vertices";
    for (std::uint32_t i = 0; i < face.count; ++i) {
      const std::uint32_t a = p.loops[face.first + i];
      const std::uint32_t b = p.loops[face.first + (i + 1) % face.count];
      if (a == b) return "an edge from a vertex to itself";
      if (++directed[{a, b}] > 1) return "an edge used twice in one direction";
      if (std::abs(planes[face.plane].distance(p.vertices[a].position)) > tolerance_mm)
        return "a vertex off the plane of its face";
    }
  }
  for (const auto& [edge, count] : directed)
    if (!directed.contains({edge.second, edge.first})) return "an edge with one face only";
  if (p.vertices.size() + p.faces.size() != directed.size() / 2 + 2) return "Euler's formula does not hold";
  for (const PolyFace& face : p.faces)
    for (const PolyVertex& v : p.vertices)
      if (planes[face.plane].distance(v.position) * (face.above ? 1.0 : -1.0) < -tolerance_mm)
        return "a vertex beyond a face";
  return {};
}

}  // namespace sonoloft
