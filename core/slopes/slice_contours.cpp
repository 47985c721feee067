#include "core/slopes/slice_contours.h"

#include <algorithm>

#include "core/slopes/contour/calming.h"
#include "core/slopes/contour/fading.h"
#include "core/slopes/windows.h"

namespace sonoloft {
namespace {

std::vector<std::uint8_t> stations(const Arcs& arcs, double step_mm) {
  std::vector<std::uint8_t> chosen(arcs.point.size(), 0);
  for (const Arc& arc : arcs.arcs) {
    if (!arc.is_surface()) continue;
    std::uint32_t last = arc.first;
    for (std::uint32_t place = arc.first; place < arc.end(); ++place) {
      const bool at_end = place == arc.first || !arc.has_edge(place);
      if (!at_end && arcs.along_mm[place] - arcs.along_mm[last] < step_mm) continue;
      chosen[place] = 1;
      last = place;
    }
  }
  return chosen;
}

}  // namespace

SliceContours::SliceContours(const Section& section, double feature_mm)
    : image_to_reference(section.image_to_reference),
      reference_to_image(section.image_to_reference.inverse(Eigen::Isometry)),
      calm(calmed(section, arcs_of(section), feature_mm)),
      arcs(arcs_of(calm)),
      shape(shape_of(calm, arcs, feature_mm)),
      borders(calm, arcs),
      is_station(stations(arcs, kStationStep * feature_mm)),
      fading_per_mm(fading_of(calm, arcs, shape, is_station, borders, feature_mm)),
      sums(arcs.point.size()),
      edge_cells(section.edges.size(), {kNoCell, kNoCell}),
      slope(arcs.point.size(), 0.0f),
      bends(section.points.size()),
      arc_is_stale(arcs.arcs.size(), 1) {}

void SliceContours::forget(const std::vector<bool>& is_removed) {
  const auto is_gone = [&](std::uint32_t cell) { return cell != kNoCell && cell != kSeveralCells && is_removed[cell]; };
  for (std::size_t place = 0; place < sums.size(); ++place)
    for (PlaneSums& side : sums[place]) {
      if (!is_gone(side.cell)) continue;
      side = {};
      walls_changed = 1;
      arc_is_stale[arcs.arc[place]] = 1;
    }
  for (auto& sides : edge_cells)
    for (std::uint32_t& cell : sides)
      if (is_gone(cell)) cell = kNoCell;
}

void SliceContours::drop_crossings(const std::vector<bool>& with) {
  std::erase_if(crossings, [&](const Crossing& c) {
    if (!with[static_cast<std::size_t>(c.other)]) return false;
    arc_is_stale[c.arc] = 1;
    return true;
  });
}

void SliceContours::add_crossings(std::span<const Crossing> more) {
  for (const Crossing& c : more) arc_is_stale[c.arc] = 1;
  crossings.insert(crossings.end(), more.begin(), more.end());
}

bool SliceContours::is_stale() const {
  return std::find(arc_is_stale.begin(), arc_is_stale.end(), 1) != arc_is_stale.end();
}

bool SliceContours::is_on_walls() const {
  return std::any_of(sums.begin(), sums.end(),
                     [](const auto& s) { return s[0].cell != kNoCell || s[1].cell != kNoCell; });
}

bool SliceContours::is_on_wall(std::uint32_t place) const {
  while (!is_station[place]) --place;  // an arc starts with one
  return sums[place][0].cell != kNoCell || sums[place][1].cell != kNoCell;
}

}  // namespace sonoloft
