#include "host/apps/measure/mesh_tree.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace sonoloft {
namespace {

/// Ericson, Real-Time Collision Detection (2005), section 5.1.5.
Eigen::Vector3d closest_on_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                    const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double sum = va + vb + vc;
  return a + vb / sum * ab + vc / sum * ac;
}

struct Search {
  const IndexedMesh& mesh;
  Eigen::Vector3d point;
  MeshTree::Nearest best;

  /// Embree prunes with floats: leave room for the rounding of the point and of the boxes.
  [[nodiscard]] float radius(double distance) const {
    return static_cast<float>(1.00001 * distance + 1e-6 * point.lpNorm<Eigen::Infinity>());
  }

  static bool visit(RTCPointQueryFunctionArguments* args) {
    Search& self = *static_cast<Search*>(args->userPtr);
    const auto [a, b, c] = corners(self.mesh, args->primID);
    const double found = (closest_on_triangle(self.point, a, b, c) - self.point).norm();
    if (!(found < self.best.distance_mm)) return false;
    self.best = {found, args->primID};
    args->query->radius = std::min(args->query->radius, self.radius(found));
    return true;
  }
};

}  // namespace

MeshTree::MeshTree(const IndexedMesh& mesh) : mesh_(mesh), device_(rtcNewDevice(nullptr)) {
  scene_.reset(rtcNewScene(device_.get()));
  rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
  const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  // Embree's own copy: it reads 16 bytes from the last vertex, ours end after 12.
  void* const vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                 sizeof(Eigen::Vector3f), mesh.positions.size());
  std::copy(mesh.positions.begin(), mesh.positions.end(), static_cast<Eigen::Vector3f*>(vertices));
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                             sizeof(mesh.triangles[0]), mesh.triangles.size());
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_.get());
}

MeshTree::Nearest MeshTree::nearest(const Eigen::Vector3d& p, double bound_mm) const {
  Search search{mesh_, p, {std::numeric_limits<double>::infinity(), 0}};
  RTCPointQuery query{};
  query.x = static_cast<float>(p.x()), query.y = static_cast<float>(p.y()), query.z = static_cast<float>(p.z());
  query.radius = search.radius(bound_mm);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene_.get(), &query, &context, &Search::visit, &search);
  return search.best;
}

Label MeshTree::label_at(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d direction(0.8317, 0.4216, 0.3612);  // along no axis of a lattice
  RTCRayHit query{};
  query.ray.org_x = static_cast<float>(p.x()), query.ray.org_y = static_cast<float>(p.y());
  query.ray.org_z = static_cast<float>(p.z());
  query.ray.dir_x = static_cast<float>(direction.x()), query.ray.dir_y = static_cast<float>(direction.y());
  query.ray.dir_z = static_cast<float>(direction.z());
  query.ray.tfar = std::numeric_limits<float>::infinity();
  query.ray.mask = ~0u;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene_.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return kOutside;
  const auto [a, b, c] = corners(mesh_, query.hit.primID);
  const bool from_behind = (b - a).cross(c - a).dot(direction) > 0;
  return from_behind ? mesh_.label_back[query.hit.primID] : mesh_.label_front[query.hit.primID];
}

}  // namespace sonoloft
