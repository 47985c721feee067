#pragma once
#include <vector>

#include "core/methods/equal_importance/equal_importance.h"
#include "core/methods/equal_importance/slice_chart.h"
#include "core/methods/stack/layered_field.h"
#include "core/methods/stack/passage.h"

namespace sonoloft {

/// Every label's distance to the surface between neighbouring sections of a chart. Frame: that of the charted slices.
class ContourBlend final : public LayeredField {
 public:
  /// @pre the charted slices outlive the blend
  ContourBlend(const ChartedSlices& slices, const EqualImportanceOptions& options);

  [[nodiscard]] const PlaneGrid& grid() const override { return grid_; }
  [[nodiscard]] const std::vector<Label>& labels() const override { return slices_.labels; }
  [[nodiscard]] double lowest_mm() const override { return slices_.box.min().z(); }
  [[nodiscard]] double highest_mm() const override { return slices_.box.max().z(); }
  void layer(double height_mm, std::span<float> values_mm) const override;

 private:
  /// At share t of the way, a node is  start + change * way(t)  inside.
  struct Course {
    float start_mm, change_mm;
    Passage passage;
  };
  using Courses = std::vector<Course>;  ///< [#nodes of sections_grid_]

  /// @param distances_mm  [#sections][#nodes of sections_grid_]
  [[nodiscard]] Courses blended(const std::vector<std::vector<float>>& distances_mm, std::size_t interval) const;
  [[nodiscard]] Courses equally_shared(const std::vector<std::vector<float>>& distances_mm, std::size_t interval) const;
  [[nodiscard]] float distance(std::size_t label, const ChartPlace& place) const;
  [[nodiscard]] Course at(const Courses& courses, const Eigen::Vector2d& p) const;

  const ChartedSlices& slices_;
  PlaneGrid grid_, sections_grid_;
  std::vector<std::vector<Courses>> courses_;  ///< [#labels][#sections - 1]; none of outside beside one material
};

}  // namespace sonoloft
