#pragma once
#include <string>
#include <vector>

#include "core/methods/metamorphosis/label_morph.h"
#include "core/methods/metamorphosis/metamorphosis.h"
#include "core/methods/stack/layered_field.h"
#include "core/methods/stack/slice_stack.h"

namespace sonoloft {

/// The fronts of all labels of a stack. Frame: the stack's.
class ContourMorph final : public LayeredField {
 public:
  ContourMorph(const SliceStack& stack, const MetamorphosisOptions& options);

  [[nodiscard]] const PlaneGrid& grid() const override { return grid_; }
  [[nodiscard]] const std::vector<Label>& labels() const override { return labels_; }
  [[nodiscard]] double lowest_mm() const override { return lowest_mm_; }
  [[nodiscard]] double highest_mm() const override { return highest_mm_; }
  void layer(double height_mm, std::span<float> values_mm) const override;

  /// What ended for want of a counterpart: one line for every label and slice.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  void note(const SliceStack& stack, Label label, const LabelMorph& morph);

  PlaneGrid grid_;
  std::vector<Label> labels_;
  StackEnds ends_;
  double lowest_mm_, highest_mm_;
  std::vector<LabelMorph> morphs_;  ///< [#labels - 1], and of all labels together where there is more than one
  std::vector<std::string> notes_;
};

}  // namespace sonoloft
