#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/slice/label.h"

namespace sonoloft {

/// What lies right of the outline of a face: nothing of this face.
inline constexpr Label kBeyondFace = 0xFFFD;

/// Of a piece of an outline.
inline constexpr std::uint32_t kNoSource = 0xFFFFFFFF;

/// A straight piece of the border between two labels of a face, or of the face's outline (right == kBeyondFace).
/// Frame: image of the face's plane, mm.
struct FaceEdge {
  Eigen::Vector2d a, b;
  Label left, right;  ///< seen with the plane's normal towards the eye
  std::uint32_t source = kNoSource;  ///< the edge of the slice's section that this is a piece of; of an outline: none
};

/// A convex face with its labels: its outline, counter-clockwise and cut where the label inside changes, and the label
/// borders in it, in no particular order. The edges with label l on one side close the region of l.
using FacePolygon = std::vector<FaceEdge>;

/// The directed line { x : normal . x + offset = 0 } of the image frame; `normal` has length 1.
struct ImageLine {
  Eigen::Vector2d normal;
  double offset_mm;
  [[nodiscard]] double distance(const Eigen::Vector2d& p) const { return normal.dot(p) + offset_mm; }
};

/// The parts below (distance < 0) and above the line; one is empty when the line misses the face.
/// @cost O(#edges + #crossings log #crossings)
[[nodiscard]] std::pair<FacePolygon, FacePolygon> split(const FacePolygon& polygon, const ImageLine& line);

/// Area in mm^2 of all that is labelled `label` (every label: kBeyondFace).
[[nodiscard]] double area(const FacePolygon& polygon, Label label = kBeyondFace);

[[nodiscard]] bool has_unknown(const FacePolygon& polygon);

}  // namespace sonoloft
