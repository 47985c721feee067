#include "host/apps/measure/distance.h"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

constexpr std::size_t kSamples = 100'000;
constexpr std::size_t kBlock = 1024;  // fixed, so that the order of summation is

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

std::array<Eigen::Vector3d, 3> corners(const IndexedMesh& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  return {mesh.positions[t[0]].cast<double>(), mesh.positions[t[1]].cast<double>(),
          mesh.positions[t[2]].cast<double>()};
}

/// Embree's tree over the triangles of a mesh, which must outlive it.
class ClosestPoint {
 public:
  explicit ClosestPoint(const IndexedMesh& mesh) : mesh_(mesh), device_(rtcNewDevice(nullptr)) {
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

  /// Distance from p; `bound` is known not to be below it.
  [[nodiscard]] double distance(const Eigen::Vector3d& p, double bound) const {
    Search search{mesh_, p, std::numeric_limits<double>::infinity()};
    RTCPointQuery query{};
    query.x = static_cast<float>(p.x()), query.y = static_cast<float>(p.y()), query.z = static_cast<float>(p.z());
    query.radius = search.radius(bound);
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_.get(), &query, &context, &Search::visit, &search);
    return search.best;
  }

 private:
  struct Search {
    const IndexedMesh& mesh;
    Eigen::Vector3d point;
    double best;

    /// Embree prunes with floats: leave room for the rounding of the point and of the boxes.
    [[nodiscard]] float radius(double distance) const {
      return static_cast<float>(1.00001 * distance + 1e-6 * point.lpNorm<Eigen::Infinity>());
    }

    static bool visit(RTCPointQueryFunctionArguments* args) {
      Search& self = *static_cast<Search*>(args->userPtr);
      const auto [a, b, c] = corners(self.mesh, args->primID);
      const double found = (closest_on_triangle(self.point, a, b, c) - self.point).norm();
      if (!(found < self.best)) return false;
      self.best = found;
      args->query->radius = std::min(args->query->radius, self.radius(found));
      return true;
    }
  };
  struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };

  const IndexedMesh& mesh_;
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release> device_;
  std::unique_ptr<std::remove_pointer_t<RTCScene>, Release> scene_;
};

/// Points spread evenly over the area; in the square of a triangle's two parameters they follow the R2 sequence
/// (Roberts 2018), folded.
std::vector<Eigen::Vector3d> samples_of(const IndexedMesh& mesh) {
  std::vector<double> area_up_to(mesh.triangles.size());
  double total = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = corners(mesh, t);
    area_up_to[t] = total += 0.5 * (b - a).cross(c - a).norm();
  }
  std::vector<Eigen::Vector3d> samples(kSamples);
  for (std::size_t s = 0, t = 0; s < kSamples; ++s) {
    const double place = (static_cast<double>(s) + 0.5) / static_cast<double>(kSamples) * total;
    while (t + 1 < area_up_to.size() && area_up_to[t] < place) ++t;
    double u = std::fmod(0.5 + 0.7548776662466927 * static_cast<double>(s), 1.0);
    double v = std::fmod(0.5 + 0.5698402909980532 * static_cast<double>(s), 1.0);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const auto [a, b, c] = corners(mesh, t);
    samples[s] = a + u * (b - a) + v * (c - a);
  }
  return samples;
}

std::vector<Eigen::Vector3d> vertices_of(const IndexedMesh& mesh) {
  std::vector<bool> used(mesh.positions.size());
  for (const auto& t : mesh.triangles) used[t[0]] = used[t[1]] = used[t[2]] = true;
  std::vector<Eigen::Vector3d> vertices;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) vertices.push_back(mesh.positions[v].cast<double>());
  }
  return vertices;
}

SurfaceDistance distance_of(const std::vector<Eigen::Vector3d>& points, const ClosestPoint& surface, int threads) {
  std::vector<SurfaceDistance> blocks((points.size() + kBlock - 1) / kBlock, SurfaceDistance{0, 0});
  parallel_for(blocks.size(), 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t block = first; block < last; ++block) {
      double bound = std::numeric_limits<double>::infinity();
      for (std::size_t i = block * kBlock; i < std::min(points.size(), (block + 1) * kBlock); ++i) {
        // Neighbours in the list are neighbours in space, mostly: the last distance bounds the next.
        if (i > block * kBlock) bound += (points[i] - points[i - 1]).norm();
        bound = surface.distance(points[i], bound);
        blocks[block].mean_mm += bound;
        blocks[block].max_mm = std::max(blocks[block].max_mm, bound);
      }
    }
  });
  SurfaceDistance all{0, 0};
  for (const SurfaceDistance& block : blocks) {
    all.mean_mm += block.mean_mm;
    all.max_mm = std::max(all.max_mm, block.max_mm);
  }
  all.mean_mm /= static_cast<double>(points.size());
  return all;
}

/// From `from` to `to`.
SurfaceDistance one_sided(const IndexedMesh& from, const ClosestPoint& to, int threads) {
  const SurfaceDistance area = distance_of(samples_of(from), to, threads);
  const SurfaceDistance vertices = distance_of(vertices_of(from), to, threads);
  return {area.mean_mm, std::max(area.max_mm, vertices.max_mm)};
}

}  // namespace

SurfaceDistance surface_distance(const IndexedMesh& mesh, const IndexedMesh& truth, int threads) {
  if (mesh.triangles.empty() || truth.triangles.empty()) {
    return {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }
  const SurfaceDistance there = one_sided(mesh, ClosestPoint(truth), threads);
  const SurfaceDistance back = one_sided(truth, ClosestPoint(mesh), threads);
  return {0.5 * (there.mean_mm + back.mean_mm), std::max(there.max_mm, back.max_mm)};
}

IndexedMesh triangles_of(const IndexedMesh& mesh, Label label) {
  IndexedMesh part;
  part.positions = mesh.positions;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.label_front[t] != label && mesh.label_back[t] != label) continue;
    part.triangles.push_back(mesh.triangles[t]);
    part.label_front.push_back(mesh.label_front[t]);
    part.label_back.push_back(mesh.label_back[t]);
  }
  return part;
}

}  // namespace sonoloft
