#include "core/methods/metamorphosis/contour_morph.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>

#include "core/methods/stack/signed_distance.h"
#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

/// Nodes around the contours: the band of a front, and what is looked at beside.
constexpr int kMargin = 6;

/// The slices as one label sees them; with round ends an empty one beyond either end.
DistanceStack distances(const SliceStack& stack, const PlaneGrid& grid, const MetamorphosisOptions& options,
                        const std::function<bool(Label)>& is_inside) {
  DistanceStack out;
  const auto nowhere_mm = static_cast<float>(-2 * stack.bounds.sizes().norm());
  out.distances_mm.resize(stack.sections.size());
  parallel_for(stack.sections.size(), 1, options.threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      out.distances_mm[i] = signed_distance(stack.sections[i], is_inside, grid, nowhere_mm);
  });
  out.heights_mm = stack.heights_mm;
  if (options.ends == StackEnds::flat) return out;
  const auto add = [&](std::ptrdiff_t at, double height_mm) {
    out.heights_mm.insert(out.heights_mm.begin() + at, height_mm);
    out.distances_mm.emplace(out.distances_mm.begin() + at, grid.size(), nowhere_mm);
  };
  const std::vector<double> h = out.heights_mm;
  add(std::ssize(h), 2 * h.back() - h[h.size() - 2]);
  add(0, 2 * h[0] - h[1]);
  return out;
}

}  // namespace

ContourMorph::ContourMorph(const SliceStack& stack, const MetamorphosisOptions& options)
    : grid_(PlaneGrid::over(stack.bounds, options.spacing_mm, kMargin)), labels_(stack.labels), ends_(options.ends) {
  const auto add = [&](const std::function<bool(Label)>& is_inside) {
    DistanceStack of_label = distances(stack, grid_, options, is_inside);
    lowest_mm_ = of_label.heights_mm.front();
    highest_mm_ = of_label.heights_mm.back();
    morphs_.emplace_back(grid_, std::move(of_label), options.threads);
  };
  for (std::size_t l = 1; l < labels_.size(); ++l) {
    add([label = labels_[l]](Label other) { return other == label; });
    note(stack, labels_[l], morphs_.back());
  }
  if (labels_.size() > 2) add([](Label other) { return other != kOutside; });
}

void ContourMorph::note(const SliceStack& stack, Label label, const LabelMorph& morph) {
  const std::size_t before = ends_ == StackEnds::round ? 1 : 0;
  const auto say = [&](const Unmatched& unmatched, std::size_t in, std::size_t beside) {
    if (unmatched.parts + unmatched.holes == 0) return;
    std::ostringstream line;
    line << "label " << label << ": " << unmatched.parts << " parts and " << unmatched.holes << " holes of slice "
         << stack.slices[in] << " (" << unmatched.area_mm2 << " mm2) overlap nothing of theirs in slice "
         << stack.slices[beside] << ": they are closed half-way there";
    notes_.push_back(line.str());
  };
  for (std::size_t i = 0; i + 1 < stack.sections.size(); ++i) {
    say(morph.sweeps()[i + before].in_lower, i, i + 1);
    say(morph.sweeps()[i + before].in_upper, i + 1, i);
  }
}

void ContourMorph::layer(double height_mm, std::span<float> values_mm) const {
  const std::size_t nodes = grid_.size();
  const double inside_mm = std::clamp(height_mm, lowest_mm_, highest_mm_);
  const auto to_end_mm = static_cast<float>(std::min(height_mm - lowest_mm_, highest_mm_ - height_mm));
  for (std::size_t l = 1; l < labels_.size(); ++l) {
    const std::span<float> values = values_mm.subspan(l * nodes, nodes);
    morphs_[l - 1].layer(inside_mm, values);
    if (ends_ == StackEnds::flat)
      for (float& value : values) value = std::min(value, to_end_mm);
  }
  const std::span<float> outside = values_mm.first(nodes);
  if (labels_.size() > 2)
    morphs_.back().layer(inside_mm, outside);
  else
    std::ranges::copy(values_mm.subspan(nodes, nodes), outside.begin());
  for (float& value : outside) value = -(ends_ == StackEnds::flat ? std::min(value, to_end_mm) : value);
}

}  // namespace sonoloft
