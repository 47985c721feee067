#pragma once
#include <memory>
#include <span>
#include <vector>

#include "core/slopes/slice_contours.h"

namespace sonoloft {

/// What the planes around one cell say about the slopes of the contours on its walls. Keeps room to work in.
class PlaneSlopes {
 public:
  /// @param slices  [SliceId] of all walls of the cell
  void renew(const CellComplex& cells, CellId cell, std::span<const std::unique_ptr<SliceContours>> slices,
             double feature_mm);

 private:
  /// A wall of the cell that shows contours.
  struct Wall {
    SliceId slice;
    SliceContours* contours;
    const FacePolygon* polygon;
    bool above;
    std::uint32_t hint;  ///< see BorderTree
  };
  /// Another wall as seen from one.
  struct Neighbour {
    Wall* wall;
    double along;      ///< cosine of the normal of the one and the direction to the other
    double side;       ///< sign that takes the other's normal to that direction
    double height_mm;  ///< of the place over the other
    Eigen::Vector2d foot;
    double weight_bound;
  };
  /// What one of these says.
  struct Term {
    double weight, height_mm;
    double along, outside;  ///< cosines of the direction to it with the wall's normal and the contour's
    double depth_mm;        ///< of the foot in the contour's left label
  };

  void find_walls(const CellComplex& cells, CellId cell, std::span<const std::unique_ptr<SliceContours>> slices);
  void find_places(const CellComplex& cells, CellId cell, const Wall& wall);
  void find_neighbours(const Wall& wall);
  [[nodiscard]] double solve(double weights) const;
  [[nodiscard]] PlaneSums sum(const Wall& wall, std::uint32_t place);

  double feature_mm_ = 0;
  std::vector<CellFace> faces_;
  std::vector<Wall> walls_;
  std::vector<std::uint32_t> places_;
  std::vector<Neighbour> neighbours_;
  std::vector<Term> terms_;
};

}  // namespace sonoloft
