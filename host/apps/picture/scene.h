#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "host/apps/picture/picture.h"

namespace sonoloft {

/// View frame: origin in the eye, x to the right, y down, z forward, mm. Samples are 2 x 2 to a pixel.
struct Camera {
  Eigen::Vector3d eye_mm;
  Eigen::Matrix3d to_view;  ///< rotation, reference to view
  int width, height;        ///< samples
  double focal;             ///< samples per unit of x / z

  /// The ray through the middle of a sample: view frame, z = 1.
  [[nodiscard]] Eigen::Vector3f ray(int column, int row) const {
    return {static_cast<float>((column + 0.5 - 0.5 * width) / focal),
            static_cast<float>((row + 0.5 - 0.5 * height) / focal), 1.0f};
  }
};

/// A vertex on the picture: position in samples, on a grid of 2^-8 so that the tests of edges are exact.
struct Projected {
  double x, y;
  float inverse_depth;
};

/// A plane in the view frame; points with normal.dot(p) > offset are cut away.
struct ViewCut {
  Eigen::Vector3f normal;
  float offset;
  /// Depth at which the ray passes from what is cut away into what is kept, or 0.
  [[nodiscard]] float entry_depth(const Eigen::Vector3f& ray) const;
  [[nodiscard]] bool removes(const Eigen::Vector3f& point) const { return normal.dot(point) > offset; }
};

/// The mesh as the camera sees it.
struct Scene {
  const IndexedMesh& mesh;
  Camera camera;
  std::vector<Eigen::Vector3f> view;                          ///< [#V] mm, view frame
  std::vector<Projected> projected;                           ///< [#V]
  std::vector<Eigen::Vector3f> face_normal;                   ///< [#T] view frame
  std::vector<std::array<Eigen::Vector3f, 3>> corner_normal;  ///< [#T] smooth across neighbours of the same two labels
  std::vector<bool> glass;                                    ///< [65536] by label
  std::optional<ViewCut> cut;
  float size_mm;  ///< diagonal of what is framed
};

/// @pre the mesh has a triangle and only finite vertices; the options are checked
[[nodiscard]] Scene make_scene(const IndexedMesh& mesh, const PictureOptions& options, int threads);

}  // namespace sonoloft
