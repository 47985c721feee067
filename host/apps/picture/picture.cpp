#include "host/apps/picture/picture.h"

#include <Eigen/Geometry>
#include <cassert>

#include "host/apps/picture/legend.h"
#include "host/apps/picture/shade.h"

namespace sonoloft {
namespace {

constexpr int kSmallest_px = 16, kLargest_px = 8192;

Result<void> check(const PictureOptions& options) {
  const auto in_range = [](int size) { return size >= kSmallest_px && size <= kLargest_px; };
  if (!in_range(options.width_px) || !in_range(options.height_px)) {
    return fail(ErrorCode::invalid_argument, "a picture is 16 to 8192 pixels wide and high: choose another size");
  }
  const double turn = options.look.normalized().cross(options.up.normalized()).norm();
  if (!(turn > 1e-6)) {  // also when one of them is zero or not finite
    return fail(ErrorCode::invalid_argument, "the directions to look in and upwards must differ: choose others");
  }
  if (options.cut &&
      !(options.cut->point_mm.allFinite() && options.cut->normal.allFinite() && options.cut->normal.norm() > 0)) {
    return fail(ErrorCode::invalid_argument, "a cut needs a finite point and a normal: choose others");
  }
  return {};
}

Result<void> check(const IndexedMesh& mesh) {
  if (mesh.triangles.empty()) return fail(ErrorCode::empty_input, "the mesh has no triangle: there is nothing to draw");
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      assert(v < mesh.positions.size());
      if (!mesh.positions[v].allFinite()) {
        return fail(ErrorCode::non_finite, "vertex " + std::to_string(v) + " is not finite: repair the mesh");
      }
    }
  }
  return {};
}

}  // namespace

Result<Picture> draw(const IndexedMesh& mesh, const PictureOptions& options, int threads) {
  if (auto ok = check(options); !ok) return tl::unexpected(ok.error());
  if (auto ok = check(mesh); !ok) return tl::unexpected(ok.error());
  const Scene scene = make_scene(mesh, options, threads);
  Picture picture = shade(scene, rasterise(scene, threads), options, threads);
  draw_legend(options, picture);
  return picture;
}

}  // namespace sonoloft
