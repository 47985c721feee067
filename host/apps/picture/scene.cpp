#include "host/apps/picture/scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

constexpr double kHalfHeight = 0.25;    // tangent of half the vertical opening angle
constexpr double kMargin = 1.08;        // around what is framed
constexpr float kCreaseCosine = 0.55f;  // sharper edges stay sharp
constexpr std::size_t kGrain = 4096;

Eigen::Matrix3d rotation_to_view(const PictureOptions& options) {
  const Eigen::Vector3d forward = options.look.normalized();
  const Eigen::Vector3d right = forward.cross(options.up).normalized();
  Eigen::Matrix3d rows;
  rows << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  return rows;
}

/// What decides the framing: the vertices of all triangles, or of those that a cut does not take away wholly.
std::vector<Eigen::Vector3d> framed_points(const IndexedMesh& mesh, const std::optional<Cut>& cut) {
  std::vector<bool> removed(mesh.positions.size()), used(mesh.positions.size());
  for (std::size_t v = 0; cut && v < removed.size(); ++v) {
    removed[v] = cut->normal.dot(mesh.positions[v].cast<double>() - cut->point_mm) > 0;
  }
  bool any = false;
  for (const auto& [a, b, c] : mesh.triangles) {
    if (removed[a] && removed[b] && removed[c]) continue;
    used[a] = used[b] = used[c] = any = true;
  }
  if (!any) return framed_points(mesh, std::nullopt);
  std::vector<Eigen::Vector3d> points;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) points.push_back(mesh.positions[v].cast<double>());
  }
  return points;
}

/// The nearest eye from which all points lie within the picture. In x, a point is inside when |x - eye_x| <= slope *
/// (z - eye_z): the two extremes of x - slope z and -x - slope z alone decide, and likewise in y.
Eigen::Vector3d fitting_eye(const std::vector<Eigen::Vector3d>& points, const Eigen::Matrix3d& to_view, double aspect) {
  Eigen::Vector3d eye(0, 0, std::numeric_limits<double>::infinity());
  double nearest = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 2; ++axis) {
    const double slope = kHalfHeight * (axis == 0 ? aspect : 1.0) / kMargin;
    double high = -std::numeric_limits<double>::infinity(), low = high;
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Vector3d p = to_view * (point - points[0]);
      high = std::max(high, p[axis] - slope * p.z());
      low = std::max(low, -p[axis] - slope * p.z());
      nearest = std::min(nearest, p.z());
    }
    eye[axis] = 0.5 * (high - low);
    eye.z() = std::min(eye.z(), -0.5 * (high + low) / slope);
  }
  return eye + Eigen::Vector3d(0, 0, std::min(0.0, nearest - eye.z()));
}

Camera make_camera(const std::vector<Eigen::Vector3d>& points, const PictureOptions& options, double size_mm) {
  Camera camera;
  camera.to_view = rotation_to_view(options);
  camera.width = 2 * options.width_px;
  camera.height = 2 * options.height_px;
  camera.focal = 0.5 * camera.height / kHalfHeight;
  Eigen::Vector3d eye = fitting_eye(points, camera.to_view, double(camera.width) / camera.height);
  eye.z() -= 0.02 * size_mm;  // never inside a triangle, whatever its shape
  camera.eye_mm = points[0] + camera.to_view.transpose() * eye;
  return camera;
}

void project_vertices(Scene& scene, int threads) {
  const auto& positions = scene.mesh.positions;
  scene.view.resize(positions.size());
  scene.projected.resize(positions.size());
  const Camera& camera = scene.camera;
  parallel_for(positions.size(), kGrain, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t v = first; v < last; ++v) {
      const Eigen::Vector3d p = camera.to_view * (positions[v].cast<double>() - camera.eye_mm);
      const auto on_grid = [](double s) { return std::round(std::clamp(s, -1e6, 1e6) * 256.0) / 256.0; };
      scene.view[v] = p.cast<float>();
      // Only what the cut takes away can lie behind the eye: depth <= 0 says not to draw it.
      const double scale = p.z() > 0 ? camera.focal / p.z() : 0.0;
      scene.projected[v] = {on_grid(p.x() * scale + 0.5 * camera.width), on_grid(p.y() * scale + 0.5 * camera.height),
                            p.z() > 0 ? static_cast<float>(1.0 / p.z()) : 0.0f};
    }
  });
}

/// The corners of all triangles by vertex: those of vertex v are corner[first[v]] .. corner[first[v + 1]].
struct Corners {
  std::vector<std::uint32_t> first, corner;
};

Corners corners_of(const IndexedMesh& mesh) {
  Corners corners{std::vector<std::uint32_t>(mesh.positions.size() + 1), {}};
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) ++corners.first[v + 1];
  }
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) corners.first[v + 1] += corners.first[v];
  corners.corner.resize(3 * mesh.triangles.size());
  auto next = corners.first;
  for (std::size_t c = 0; c < corners.corner.size(); ++c) {
    corners.corner[next[mesh.triangles[c / 3][c % 3]]++] = static_cast<std::uint32_t>(c);
  }
  return corners;
}

/// Area-weighted means over the faces around each vertex that separate the same labels and bend little.
void smooth_normals(Scene& scene, int threads) {
  const IndexedMesh& mesh = scene.mesh;
  const std::size_t count = mesh.triangles.size();
  scene.face_normal.resize(count);
  scene.corner_normal.resize(count);
  std::vector<Eigen::Vector3f> weighted(count);
  for (std::size_t t = 0; t < count; ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    weighted[t] = (scene.view[b] - scene.view[a]).cross(scene.view[c] - scene.view[a]);
    scene.face_normal[t] = weighted[t].stableNormalized();
  }
  const Corners corners = corners_of(mesh);
  parallel_for(mesh.positions.size(), kGrain, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t v = first; v < last; ++v) {
      for (std::uint32_t i = corners.first[v]; i < corners.first[v + 1]; ++i) {
        const std::uint32_t t = corners.corner[i] / 3;
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        for (std::uint32_t j = corners.first[v]; j < corners.first[v + 1]; ++j) {
          const std::uint32_t other = corners.corner[j] / 3;
          if (mesh.label_front[other] == mesh.label_front[t] && mesh.label_back[other] == mesh.label_back[t] &&
              scene.face_normal[other].dot(scene.face_normal[t]) > kCreaseCosine) {
            sum += weighted[other];
          }
        }
        scene.corner_normal[t][corners.corner[i] % 3] = sum.stableNormalized();
      }
    }
  });
}

}  // namespace

float ViewCut::entry_depth(const Eigen::Vector3f& ray) const {
  const float towards = normal.dot(ray);
  return offset < 0 && towards < 0 ? offset / towards : 0.0f;
}

Scene make_scene(const IndexedMesh& mesh, const PictureOptions& options, int threads) {
  const std::vector<Eigen::Vector3d> points = framed_points(mesh, options.cut);
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& point : points) box.extend(point);
  const double size_mm = std::max(box.diagonal().norm(), 1e-6);

  Scene scene{mesh,
              make_camera(points, options, size_mm),
              {},
              {},
              {},
              {},
              std::vector<bool>(std::size_t{1} << 16),
              {},
              static_cast<float>(size_mm)};
  for (const Label label : options.transparent) scene.glass[label] = true;
  if (options.cut) {
    const Eigen::Vector3d normal = scene.camera.to_view * options.cut->normal.normalized();
    const Eigen::Vector3d point = scene.camera.to_view * (options.cut->point_mm - scene.camera.eye_mm);
    scene.cut = ViewCut{normal.cast<float>(), static_cast<float>(normal.dot(point))};
  }
  project_vertices(scene, threads);
  smooth_normals(scene, threads);
  return scene;
}

}  // namespace sonoloft
