#include "host/apps/measure/pieces.h"

#include <Eigen/Geometry>
#include <boost/pending/disjoint_sets.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "host/apps/measure/mesh_tree.h"

namespace sonoloft {
namespace {

Pieces pieces_of(const IndexedMesh& mesh, Label label, double large_mm3) {
  boost::disjoint_sets_with_storage<> sets(mesh.positions.size());  // vertices joined by triangles
  std::set<std::uint32_t> vertices;
  std::vector<std::size_t> triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if ((mesh.label_front[t] == label) == (mesh.label_back[t] == label)) continue;
    triangles.push_back(t);
    for (const std::uint32_t v : mesh.triangles[t]) {
      sets.union_set(v, mesh.triangles[t][0]);
      vertices.insert(v);
    }
  }
  std::map<std::size_t, double> volume_mm3;  // by root; hollows have less than none
  for (const std::size_t t : triangles) {
    const auto [a, b, c] = corners(mesh, t);
    volume_mm3[sets.find_set(mesh.triangles[t][0])] += (mesh.label_back[t] == label ? 1 : -1) * a.dot(b.cross(c)) / 6;
  }
  Pieces pieces{volume_mm3.size(), 0, 0};
  for (const auto& [root, volume] : volume_mm3) pieces.large += std::abs(volume) >= large_mm3;
  // Euler: V - E + F = 2 (pieces - genus), and a closed surface has 3 F = 2 E.
  const long euler = static_cast<long>(vertices.size()) - static_cast<long>(triangles.size()) / 2;
  pieces.genus = static_cast<long>(pieces.all) - euler / 2;
  return pieces;
}

}  // namespace

Pieces count_pieces(const IndexedMesh& mesh, double large_mm3) {
  std::set<Label> labels(mesh.label_front.begin(), mesh.label_front.end());
  labels.insert(mesh.label_back.begin(), mesh.label_back.end());
  labels.erase(kOutside);
  Pieces sum;
  for (const Label label : labels) {
    const Pieces of_label = pieces_of(mesh, label, large_mm3);
    sum.all += of_label.all;
    sum.large += of_label.large;
    sum.genus += of_label.genus;
  }
  return sum;
}

}  // namespace sonoloft
