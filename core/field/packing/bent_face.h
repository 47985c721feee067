#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cells/face_polygon.h"
#include "core/slice/section.h"
#include "core/slopes/vertex_bend.h"

namespace sonoloft {

/// What a face of a cell needs to know of the contours that its borders are pieces of.
struct FaceBends {
  const Section* section = nullptr;
  std::span<const VertexBend> bends;  ///< [section->points]; empty: nothing moves
};

/// The ends of an edge of a face, and how they move with the height over it: along the outline where they lie on it.
struct EdgeBends {
  VertexBend a, b;
};

/// How the ends of a face's edges move: those of pieces of contours with their contour, those of pieces of the outline
/// with the border that ends there. Ends that meet move together; corners of the face stay.
/// Threads: one call at a time.
class BentFace {
 public:
  /// @return [polygon] valid until the next call
  /// @pre    bends.bends is not empty
  /// @cost   O(#edges log #outline)
  [[nodiscard]] std::span<const EdgeBends> bend(const FacePolygon& polygon, const FaceBends& bends);

 private:
  /// Where a piece of the outline ends.
  struct OutlineEnd {
    Eigen::Vector2d point, along;
    VertexBend bend;
  };
  [[nodiscard]] std::span<OutlineEnd> outline_at(const Eigen::Vector2d& point);
  void collect_outline(const FacePolygon& polygon);
  void bend_end(const Eigen::Vector2d& point, VertexBend& bend);

  std::vector<EdgeBends> edges_;
  std::vector<OutlineEnd> outline_;  ///< by point
};

}  // namespace sonoloft
