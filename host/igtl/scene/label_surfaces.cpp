#include "host/igtl/scene/label_surfaces.h"

#include <map>
#include <utility>

namespace sonoloft::igtl {
namespace {

/// Which triangles bound which label.
std::map<Label, std::vector<std::uint32_t>> sides(const IndexedMesh& mesh) {
  std::map<Label, std::vector<std::uint32_t>> of_label;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (const Label label : {mesh.label_front[t], mesh.label_back[t]})
      if (label != kOutside) of_label[label].push_back(t);
  return of_label;
}

}  // namespace

std::vector<LabelSurface> label_surfaces(const IndexedMesh& mesh) {
  constexpr std::uint32_t kNone = 0xFFFFFFFF;
  std::vector<LabelSurface> surfaces;
  std::vector<std::uint32_t> number(mesh.positions.size(), kNone);  // of a vertex, in the surface at hand
  for (const auto& [label, triangles] : sides(mesh)) {
    LabelSurface& surface = surfaces.emplace_back(LabelSurface{label, {}, {}});
    surface.triangles.reserve(triangles.size());
    for (const std::uint32_t t : triangles) {
      auto triangle = mesh.triangles[t];
      if (mesh.label_front[t] == label) std::swap(triangle[1], triangle[2]);
      for (std::uint32_t& vertex : triangle) {
        if (number[vertex] == kNone) {
          number[vertex] = static_cast<std::uint32_t>(surface.points.size());
          const Eigen::Vector3f& p = mesh.positions[vertex];
          surface.points.push_back({-p.x(), -p.y(), p.z()});
        }
        vertex = number[vertex];
      }
      surface.triangles.push_back(triangle);
    }
    for (const std::uint32_t t : triangles)
      for (const std::uint32_t vertex : mesh.triangles[t]) number[vertex] = kNone;
  }
  return surfaces;
}

}  // namespace sonoloft::igtl
