#include "core/methods/equal_importance/slice_chart.h"

#include <algorithm>
#include <set>

#include "core/methods/equal_importance/charts.h"
#include "core/methods/stack/slice_stack.h"

namespace sonoloft {
namespace {

class StackChart final : public SliceChart {
 public:
  explicit StackChart(std::vector<double> heights_mm) : heights_mm_(std::move(heights_mm)) {}

  [[nodiscard]] std::optional<ChartPlace> locate(const Eigen::Vector3d& p) const override {
    const auto above = std::upper_bound(heights_mm_.begin() + 1, heights_mm_.end() - 1, p.z());
    const double lower = *(above - 1), step = *above - lower;
    return ChartPlace{static_cast<std::size_t>(above - heights_mm_.begin()) - 1,
                      std::clamp((p.z() - lower) / step, 0.0, 1.0), p.head<2>(), step,
                      std::min(p.z() - heights_mm_.front(), heights_mm_.back() - p.z())};
  }

 private:
  std::vector<double> heights_mm_;
};

}  // namespace

std::vector<double> differences(const std::vector<double>& ascending) {
  std::vector<double> steps(ascending.size() - 1);
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = ascending[i + 1] - ascending[i];
  return steps;
}

void summarize(ChartedSlices& charted) {
  std::set<Label> labels{kOutside};
  for (const Section& s : charted.sections) {
    for (const SectionEdge& e : s.edges) labels.insert({e.left, e.right});
    for (const Eigen::Vector2d& p : s.points)
      charted.box.extend(s.image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0));
  }
  charted.labels.assign(labels.begin(), labels.end());
}

Result<ChartedSlices> chart_stack(std::span<const TrackedSlice> slices, const std::string& method) {
  auto stack = make_stack(slices, method);
  if (!stack) return tl::unexpected<Error>(stack.error());
  ChartedSlices charted;
  charted.frame_to_reference = stack->stack_to_reference;
  charted.sections = std::move(stack->sections);
  charted.steps = differences(stack->heights_mm);
  charted.chart = std::make_unique<StackChart>(std::move(stack->heights_mm));
  summarize(charted);
  return charted;
}

Result<ChartedSlices> chart_of(std::span<const TrackedSlice> slices, const std::string& method) {
  if (slices.size() < 2 || first_oblique(slices) == slices.size()) return chart_stack(slices, method);
  if (auto valid = check_slices(slices); !valid) return tl::unexpected<Error>(valid.error());
  if (const auto axis = common_axis(slices)) return chart_rotation(slices, *axis, method);
  return chart_spine(slices, method);
}

}  // namespace sonoloft
