#include "core/methods/network/contour_surfaces.h"

namespace sonoloft {

MethodSurfaces as_mesh(ContourSurfaces surfaces) {
  IndexedMesh mesh;
  for (const Eigen::Vector3d& p : surfaces.positions) mesh.positions.push_back(p.cast<float>());
  mesh.triangles = std::move(surfaces.triangles);
  mesh.label_front = std::move(surfaces.label_front);
  mesh.label_back = std::move(surfaces.label_back);
  return {std::move(mesh), std::move(surfaces.notes)};
}

}  // namespace sonoloft
