#include "core/cells/slice_cut.h"

#include <utility>

namespace sonoloft {

void SliceCut::cut(Arrival first, double width_mm) {
  std::vector<Arrival> left;
  left.push_back(std::move(first));
  while (!left.empty()) {
    Arrival arrival = std::move(left.back());
    left.pop_back();
    if (!has_known_part(arrival.polygon)) continue;
    Cell& cell = store_.cells[static_cast<std::uint32_t>(arrival.cell)];
    if (!is_wide_enough(cell.shape, store_.planes[plane_], width_mm)) {
      ++delta_.too_thin;
      continue;
    }
    used_ = true;
    if (cell.label != kBeyondFace && uniform_label(arrival.polygon) == cell.label)
      cell.remembered.push_back(plane_);
    else if (cell.remembered.empty())
      cut_by_slice(std::move(arrival));
    else
      cut_by_remembered(std::move(arrival), left);
  }
}

void SliceCut::cut_by_slice(Arrival arrival) {
  const auto side = sides(store_, store_.cells[static_cast<std::uint32_t>(arrival.cell)].shape, store_.planes[plane_]);
  if (side.empty()) return;
  PlaneCut& cut = cuts_.try_emplace(plane_, store_, PlaneId{plane_}, delta_.work).first->second;
  delta_.lower.push_back(arrival.cell);
  delta_.upper.push_back(cut.cut(arrival.cell, std::move(arrival.polygon), side));
}

void SliceCut::cut_by_remembered(Arrival arrival, std::vector<Arrival>& left) {
  Cell& whole = store_.cells[static_cast<std::uint32_t>(arrival.cell)];
  const std::vector<std::uint32_t> planes = std::exchange(whole.remembered, {});
  const std::uint32_t plane = planes.front();
  const auto rest = std::span(planes).subspan(1);
  const auto side = sides(store_, whole.shape, store_.planes[plane]);
  if (side.empty()) {
    whole.remembered.assign(rest.begin(), rest.end());
    left.push_back(std::move(arrival));
    return;
  }
  PlaneCut& cut = cuts_.try_emplace(plane, store_, PlaneId{plane}, delta_.work).first->second;
  const CellId parts[2] = {arrival.cell, cut.cut_uniform(arrival.cell, side)};
  auto polygons = parts_at(store_, plane, store_.frames[plane_], std::move(arrival.polygon), delta_.work);
  for (const std::size_t upper : {std::size_t{0}, std::size_t{1}}) {
    Cell& part = store_.cells[static_cast<std::uint32_t>(parts[upper])];
    for (const std::uint32_t p : rest)
      if (is_wide_enough(part.shape, store_.planes[p], store_.min_gap_mm)) part.remembered.push_back(p);
    left.push_back({parts[upper], std::move(polygons[upper])});
  }
}

}  // namespace sonoloft
