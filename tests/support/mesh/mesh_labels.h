#pragma once
#include <embree3/rtcore.h>

#include <limits>
#include <memory>
#include <vector>

#include "core/mesh/mesh.h"

namespace sonoloft::test {

/// What a mesh says of a point: the side that the first triangle along a ray turns to it. Rays by Embree, so that
/// nothing of the code under test answers. Coordinates are taken relative to the mesh's first vertex: floats far from
/// zero.
class MeshLabels {
 public:
  explicit MeshLabels(const IndexedMesh& mesh)
      : mesh_(mesh), device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    origin_ = mesh.positions.empty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(mesh.positions[0].cast<double>());
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), mesh.positions.size()));
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
      for (int k = 0; k < 3; ++k)
        vertices[3 * i + static_cast<std::size_t>(k)] =
            static_cast<float>(static_cast<double>(mesh.positions[i][k]) - origin_[k]);
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), mesh.triangles.size()));
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) indices[3 * i + k] = mesh.triangles[i][k];
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  MeshLabels(const MeshLabels&) = delete;
  MeshLabels& operator=(const MeshLabels&) = delete;
  ~MeshLabels() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  [[nodiscard]] Label at(const Eigen::Vector3d& point_mm) const {
    const Eigen::Vector3f p = (point_mm - origin_).cast<float>();
    const Eigen::Vector3f d(0.8317f, 0.4216f, 0.3612f);  // along no axis of a lattice
    RTCRayHit query{};
    query.ray.org_x = p.x();
    query.ray.org_y = p.y();
    query.ray.org_z = p.z();
    query.ray.dir_x = d.x();
    query.ray.dir_y = d.y();
    query.ray.dir_z = d.z();
    query.ray.tfar = std::numeric_limits<float>::infinity();
    query.ray.mask = 0xFFFFFFFFu;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return kOutside;
    const auto& t = mesh_.triangles[query.hit.primID];
    const Eigen::Vector3f normal =
        (mesh_.positions[t[1]] - mesh_.positions[t[0]]).cross(mesh_.positions[t[2]] - mesh_.positions[t[0]]);
    return normal.dot(d) < 0.0f ? mesh_.label_front[query.hit.primID] : mesh_.label_back[query.hit.primID];
  }

 private:
  const IndexedMesh& mesh_;
  RTCDevice device_;
  RTCScene scene_;
  Eigen::Vector3d origin_;
};

}  // namespace sonoloft::test
