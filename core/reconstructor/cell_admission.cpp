#include "core/reconstructor/cell_admission.h"

#include <algorithm>
#include <limits>

#include "core/slice/section_raster.h"

namespace sonoloft {
namespace {

// In units of the background's spacing H, and of H^2. With H = 2.5 mm: 1.5 mm, 5 mm^2, 0.5 mm, 4 mm^2, 4 mm.
constexpr double kRaster = 0.6;
constexpr double kDiffers = 0.8;      ///< area in which slice and field differ, to cut
constexpr double kWidth = 0.2;        ///< of both parts then
constexpr double kUnseen = 0.64;      ///< area of which nothing was known, to cut ...
constexpr double kUnseenShare = 0.1;  ///< ... beyond this share of what the slice shows in the cell
constexpr double kUnseenWidth = 1.6;  ///< of both parts then
constexpr float kMeasured = 0.5f;     ///< least measured share of a point that walls explain
constexpr float kNearSlices = 0.5f;   ///< least weight of slices through a point that they explain

constexpr double kLeaveWhole = std::numeric_limits<double>::infinity();

}  // namespace

void CellAdmission::raster(const Section& section, const CellComplex& cells, double spacing_mm) {
  std::vector<Eigen::Vector3d> points;
  std::vector<Label> labels;
  Eigen::AlignedBox3d bounds;
  const SectionRaster raster = rasterize(section, spacing_mm, cells.box());
  for (int y = 0; y < raster.height; ++y)
    for (int x = 0; x < raster.width; ++x) {
      if (raster.at(x, y) == kUnknown) continue;
      const Eigen::Vector2d p = raster.point(x, y);
      points.push_back(section.image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0));
      labels.push_back(raster.at(x, y));
      bounds.extend(points.back());
    }
  point_mm_.clear();
  label_.clear();
  groups_.clear();
  if (points.empty()) return;
  std::vector<std::uint32_t> order;
  std::vector<CellPoints> found;
  cells.locate(bounds, points, order, found);
  for (const std::uint32_t i : order) {
    point_mm_.push_back(points[i]);
    label_.push_back(labels[i]);
  }
  for (const CellPoints& of_cell : found) groups_.push_back({of_cell.cell, of_cell.first, of_cell.count, 0, 0});
}

void CellAdmission::pack(const CellComplex& cells) {
  batch_.clear();
  std::vector<CellFace> faces;
  for (Group& group : groups_) {
    cells.faces(group.cell, faces);
    group.packed = batch_.cells.add(faces, cells.centre(group.cell));
    if (!batch_.cells.constant(group.packed))
      group.block = batch_.add_points(group.packed, std::span(point_mm_).subspan(group.first, group.count));
  }
}

double CellAdmission::width(const Group& group, const Background& background) {
  background.local(std::span(point_mm_).subspan(group.first, group.count), weight_, near_);
  const std::span<const Label> labels = batch_.cells.labels(group.packed);
  const auto known = [&](std::uint32_t slot, std::size_t k) {
    return batch_.cells.constant(group.packed) ? 1.0f : batch_.row(group.block, slot)[k];
  };

  const bool partly_unknown = labels.back() == kUnknown;
  std::size_t differ = 0, unseen = 0;
  for (std::size_t k = 0; k < group.count; ++k) {
    const float unmeasured = partly_unknown ? known(static_cast<std::uint32_t>(labels.size() - 1), k) : 0.0f;
    if (1.0f - unmeasured < kMeasured && weight_[k] < kNearSlices) {
      ++unseen;
      continue;
    }
    const auto share = [&](Label label) {
      const auto slot = std::lower_bound(labels.begin(), labels.end(), label);
      const auto row = std::lower_bound(near_.labels.begin(), near_.labels.end(), label);
      const float measured =
          slot != labels.end() && *slot == label ? known(static_cast<std::uint32_t>(slot - labels.begin()), k) : 0.0f;
      const float filled = row != near_.labels.end() && *row == label
                               ? near_.share[static_cast<std::size_t>(row - near_.labels.begin()) * group.count + k]
                               : 0.0f;
      return measured + unmeasured * filled;
    };
    const Label said = label_[group.first + k];
    const float of_said = share(said);
    const auto beats = [&](Label label) {
      return label != said && label != kUnknown && (label < said ? share(label) >= of_said : share(label) > of_said);
    };
    if (std::any_of(labels.begin(), labels.end(), beats) ||
        std::any_of(near_.labels.begin(), near_.labels.end(), beats))
      ++differ;
  }
  const double h = background.spacing_mm(), point_mm2 = kRaster * kRaster * h * h;
  if (point_mm2 * static_cast<double>(differ) >= kDiffers * h * h) return kWidth * h;
  const double seen_mm2 = point_mm2 * group.count;
  if (point_mm2 * static_cast<double>(unseen) >= kUnseenShare * seen_mm2 + kUnseen * h * h) return kUnseenWidth * h;
  return kLeaveWhole;
}

Result<CellAdmission::Widths> CellAdmission::judge(const Section& section, const CellComplex& cells,
                                                   const Background& background, FieldEvaluator& evaluator) {
  raster(section, cells, kRaster * background.spacing_mm());
  pack(cells);
  if (const auto done = evaluator.evaluate(batch_); !done) return tl::unexpected<Error>(done.error());
  Widths widths;
  for (const Group& group : groups_)
    if (const double mm = width(group, background); mm < kLeaveWhole) widths.emplace(group.cell, mm);
  return widths;
}

}  // namespace sonoloft
