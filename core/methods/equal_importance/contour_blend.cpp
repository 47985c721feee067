#include "core/methods/equal_importance/contour_blend.h"

#include <algorithm>
#include <cmath>

#include "core/methods/equal_importance/equal_share.h"
#include "core/methods/stack/signed_distance.h"
#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

/// Nodes around the contours.
constexpr int kMargin = 4;

}  // namespace

ContourBlend::ContourBlend(const ChartedSlices& slices, const EqualImportanceOptions& options) : slices_(slices) {
  Eigen::AlignedBox2d of_sections;
  for (const Section& s : slices.sections)
    for (const Eigen::Vector2d& p : s.points) of_sections.extend(p);
  grid_ = PlaneGrid::over({slices.box.min().head<2>(), slices.box.max().head<2>()}, options.spacing_mm, kMargin);
  sections_grid_ = PlaneGrid::over(of_sections, options.spacing_mm, kMargin);
  const auto nowhere_mm = static_cast<float>(-2 * slices.box.sizes().norm());
  courses_.resize(slices.labels.size());
  for (std::size_t l = slices.labels.size() > 2 ? 0 : 1; l < slices.labels.size(); ++l) {
    const Label label = slices.labels[l];
    std::vector<std::vector<float>> distances(slices.sections.size());
    parallel_for(distances.size(), 1, options.threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i)
        distances[i] = signed_distance(
            slices.sections[i], [label](Label other) { return other == label; }, sections_grid_,
            label == kOutside ? -nowhere_mm : nowhere_mm);
    });
    std::vector<Courses>& courses = courses_[l];
    courses.resize(distances.size() - 1);
    parallel_for(courses.size(), 1, options.threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i)
        courses[i] = options.form == ContourForm::dense ? blended(distances, i) : equally_shared(distances, i);
    });
  }
}

ContourBlend::Courses ContourBlend::blended(const std::vector<std::vector<float>>& distances_mm,
                                            std::size_t interval) const {
  const std::vector<float>&lower = distances_mm[interval], &upper = distances_mm[interval + 1];
  Courses courses(lower.size());
  for (std::size_t n = 0; n < courses.size(); ++n) courses[n] = {lower[n], upper[n] - lower[n], {}};
  return courses;
}

ContourBlend::Courses ContourBlend::equally_shared(const std::vector<std::vector<float>>& distances_mm,
                                                   std::size_t interval) const {
  Courses courses = blended(distances_mm, interval);
  const auto height = [&](std::size_t i) { return static_cast<float>(slices_.steps[i]); };
  const auto mean_speed = [&](std::size_t i, std::size_t n) {
    return (distances_mm[i + 1][n] - distances_mm[i][n]) / height(i);
  };
  const auto speed = [&](std::size_t section, std::size_t n) {
    if (section == 0) return mean_speed(0, n);
    if (section == slices_.steps.size()) return mean_speed(section - 1, n);
    return speed_through(mean_speed(section - 1, n), mean_speed(section, n), height(section - 1), height(section));
  };
  const std::vector<Share> shares = equal_shares(sections_grid_, distances_mm[interval], distances_mm[interval + 1]);
  for (std::size_t n = 0; n < courses.size(); ++n) {
    Course& c = courses[n];
    if (shares[n].per_mm > 0) {
      c.change_mm = (c.start_mm > 0 ? -1 : 1) / shares[n].per_mm;
      c.start_mm = -shares[n].way * c.change_mm;
    }
    const auto slope = [&](std::size_t section) {
      return passage_slope(speed(section, n), height(interval), c.change_mm, 3);
    };
    c.passage = {slope(interval), slope(interval + 1)};
  }
  return courses;
}

/// Between nodes: linear; beyond the grid that of the nearest node.
ContourBlend::Course ContourBlend::at(const Courses& courses, const Eigen::Vector2d& p) const {
  const PlaneGrid& g = sections_grid_;
  const Eigen::Vector2d steps = (p / g.spacing_mm - g.first.cast<double>()).array() - 0.5;
  const double x = std::clamp(steps.x(), 0.0, g.width - 1.001), y = std::clamp(steps.y(), 0.0, g.height - 1.001);
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const auto u = static_cast<float>(x - i), v = static_cast<float>(y - j);
  const Course *low = &courses[g.index(i, j)], *high = &courses[g.index(i, j + 1)];
  const auto mix = [&](auto member) {
    return (1 - v) * ((1 - u) * member(low[0]) + u * member(low[1])) +
           v * ((1 - u) * member(high[0]) + u * member(high[1]));
  };
  return {
      mix([](const Course& c) { return c.start_mm; }),
      mix([](const Course& c) { return c.change_mm; }),
      {mix([](const Course& c) { return c.passage.at_start; }), mix([](const Course& c) { return c.passage.at_end; })}};
}

/// How far a point is inside of a label.
float ContourBlend::distance(std::size_t label, const ChartPlace& place) const {
  const Course course = at(courses_[label][place.interval], place.at);
  const auto share = static_cast<float>(place.share);
  const float climb =
      course.change_mm * course.passage.slope(share) / static_cast<float>(std::max(place.step_mm, grid_.spacing_mm));
  return (course.start_mm + course.change_mm * course.passage.way(share)) / std::sqrt(1 + climb * climb);
}

void ContourBlend::layer(double height_mm, std::span<float> values_mm) const {
  const std::size_t nodes = grid_.size(), materials = courses_.size() - 1;
  const auto far_mm = static_cast<float>(8 * grid_.spacing_mm);
  for (std::size_t n = 0; n < nodes; ++n) {
    const Eigen::Vector2i node = grid_.node(n);
    const Eigen::Vector2d p = grid_.point(node.x(), node.y());
    const auto place = slices_.chart->locate({p.x(), p.y(), height_mm});
    const float to_end_mm = place ? static_cast<float>(place->to_end_mm) : 0;
    for (std::size_t l = 1; l <= materials; ++l)
      values_mm[l * nodes + n] = place ? std::min(distance(l, *place), to_end_mm) : -far_mm;
    values_mm[n] = materials == 1 ? -values_mm[nodes + n] : place ? std::max(distance(0, *place), -to_end_mm) : far_mm;
  }
}

}  // namespace sonoloft
