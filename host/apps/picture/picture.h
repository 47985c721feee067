#pragma once
// A look without a display:  mesh -> [PICTURE] -> PNG
#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/io/labels/label_table.h"
#include "core/mesh/mesh.h"
#include "core/slice/result.h"

namespace sonoloft {

/// 8 bits per channel, top row first.
struct Picture {
  int width_px;
  int height_px;
  std::vector<std::uint8_t> rgb;  ///< [height_px * width_px * 3]
};

/// Removes the half-space that the normal points into; the labels that it cuts show as flat faces.
struct Cut {
  Eigen::Vector3d point_mm;
  Eigen::Vector3d normal;
};

struct LegendLine {
  Label label;
  std::string text;  ///< printable ASCII; other bytes become '?'
};

struct PictureOptions {
  int width_px = 1200;
  int height_px = 900;
  Eigen::Vector3d look = {-0.55, 0.75, -0.38};  ///< from the eye into the scene
  Eigen::Vector3d up = {0, 0, 1};               ///< upwards in the picture; not along `look`
  bool dark = false;                            ///< background
  LabelTable labels;                            ///< their colours
  std::vector<Label> transparent;               ///< labels drawn as glass
  std::optional<Cut> cut;
  std::vector<LegendLine> legend;  ///< lower left, first line on top
};

/// Draws the mesh in perspective, framed to fit, each surface in the colour of the label behind it.
/// The same mesh and options give the same bytes with any number of threads.
/// Frame: reference, mm, as the mesh.
/// @pre   indices are in range, threads >= 1
/// @error empty_input (no triangle), non_finite, invalid_argument (sizes beyond 16..8192, no direction)
/// @cost  O(#T + pixels); about half a second for 300,000 triangles on one core
[[nodiscard]] Result<Picture> draw(const IndexedMesh& mesh, const PictureOptions& options, int threads);

/// @error io_failed
[[nodiscard]] Result<void> write_png(const Picture& picture, const std::filesystem::path& path);

}  // namespace sonoloft
