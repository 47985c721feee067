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
  point_mm_.clear();
  label_.clear();
  const SectionRaster raster = rasterize(section, spacing_mm, cells.box());
  for (int y = 0; y < raster.height; ++y)
    for (int x = 0; x < raster.width; ++x) {
      if (raster.at(x, y) == kUnknown) continue;
      const Eigen::Vector2d p = raster.point(x, y);
      point_mm_.push_back(section.image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0));
      label_.push_back(raster.at(x, y));
    }
  Eigen::AlignedBox3d bounds;
  for (const Eigen::Vector3d& p : point_mm_) bounds.extend(p);
  if (point_mm_.empty())
    cells_.clear();
  else
    cells.locate(bounds, point_mm_, order_, cells_);
}

void CellAdmission::pack(const CellComplex& cells) {
  batch_.clear();
  groups_.clear();
  std::vector<CellFace> faces;
  for (const CellPoints& points : cells_) {
    cells.faces(points.cell, faces);
    Group group{points, batch_.cells.add(faces, cells.centre(points.cell)), 0};
    if (!batch_.cells.constant(group.packed)) {
      point_of_cell_mm_.clear();
      for (const std::uint32_t i : std::span(order_).subspan(points.first, points.count))
        point_of_cell_mm_.push_back(point_mm_[i]);
      group.block = batch_.add_points(group.packed, point_of_cell_mm_);
    }
    groups_.push_back(group);
  }
}

double CellAdmission::width(const Group& group, const Background& background) {
  const std::span<const std::uint32_t> points = std::span(order_).subspan(group.points.first, group.points.count);
  point_of_cell_mm_.clear();
  for (const std::uint32_t i : points) point_of_cell_mm_.push_back(point_mm_[i]);
  background.local(point_of_cell_mm_, weight_, near_);
  const std::span<const Label> labels = batch_.cells.labels(group.packed);
  const auto known = [&](std::uint32_t slot, std::size_t k) {
    return batch_.cells.constant(group.packed) ? 1.0f : batch_.row(group.block, slot)[k];
  };

  std::size_t differ = 0, unseen = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const bool partly_unknown = labels.back() == kUnknown;
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
                               ? near_.share[static_cast<std::size_t>(row - near_.labels.begin()) * points.size() + k]
                               : 0.0f;
      return measured + unmeasured * filled;
    };
    const Label said = label_[points[k]];
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
  const double seen_mm2 = point_mm2 * static_cast<double>(points.size());
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
    if (const double mm = width(group, background); mm < kLeaveWhole) widths.emplace(group.points.cell, mm);
  return widths;
}

}  // namespace sonoloft
