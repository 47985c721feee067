#include "core/reconstructor/cell_admission.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/slice/parallel.h"
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
  const SectionRaster raster = rasterize(section, spacing_mm, cells.box());
  const auto place = [&](const Eigen::Vector2d& p) -> Eigen::Vector3d {
    return section.image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0);
  };
  std::vector<PointRow> rows;
  std::vector<RowPiece> pieces;
  for (int y = 0; y < raster.height; ++y) {
    rows.push_back({place(raster.point(0, y)), section.image_to_reference.linear().col(0) * spacing_mm});
    for (int x = 0, begin = 0; x < raster.width; ++x) {  // the last one is unknown
      if (raster.at(x, y) != kUnknown) continue;
      if (begin < x)
        pieces.push_back(
            {static_cast<std::uint32_t>(y), static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(x)});
      begin = x + 1;
    }
  }
  std::vector<CellPieces> found;
  cells.locate_rows(rows, pieces, found);
  point_mm_.clear();
  label_.clear();
  groups_.clear();
  for (const CellPieces& of_cell : found) {
    const auto first = static_cast<std::uint32_t>(point_mm_.size());
    for (const RowPiece& piece : std::span(pieces).subspan(of_cell.first, of_cell.count))
      for (std::uint32_t x = piece.begin; x < piece.end; ++x) {
        point_mm_.push_back(rows[piece.row].first + x * rows[piece.row].step);
        label_.push_back(raster.at(static_cast<int>(x), static_cast<int>(piece.row)));
      }
    groups_.push_back({of_cell.cell, first, static_cast<std::uint32_t>(point_mm_.size()) - first, 0, 0});
  }
}

void CellAdmission::forget(std::span<const CellId> changed) {
  for (const CellId cell : changed) {
    const auto index = static_cast<std::size_t>(cell);
    if (index < packed_of_cell_.size() && std::exchange(packed_of_cell_[index], kNotPacked) != kNotPacked) ++forgotten_;
  }
}

void CellAdmission::pack(const CellComplex& cells) {
  batch_.clear_points();
  if (2 * forgotten_ > batch_.cells.size()) {
    batch_.clear();
    packed_of_cell_.clear();
    forgotten_ = 0;
  }
  packed_of_cell_.resize(cells.cell_bound(), kNotPacked);
  std::vector<CellFace> faces;
  for (Group& group : groups_) {
    std::uint32_t& packed = packed_of_cell_[static_cast<std::size_t>(group.cell)];
    if (packed == kNotPacked) {
      cells.faces(group.cell, faces);
      packed = batch_.cells.add(faces, cells.centre(group.cell));
    }
    group.packed = packed;
    if (!batch_.cells.constant(group.packed))
      group.block = batch_.add_points(group.packed, std::span(point_mm_).subspan(group.first, group.count));
  }
}

double CellAdmission::width(const Group& group, const Background& background, Scratch& scratch) const {
  PointShares& near = scratch.near;
  std::vector<float>& weight = scratch.weight;
  background.local(std::span(point_mm_).subspan(group.first, group.count), weight, near);
  const std::span<const Label> labels = batch_.cells.labels(group.packed);
  const auto known = [&](std::uint32_t slot, std::size_t k) {
    return batch_.cells.constant(group.packed) ? 1.0f : batch_.row(group.block, slot)[k];
  };

  const bool partly_unknown = labels.back() == kUnknown;
  std::size_t differ = 0, unseen = 0;
  for (std::size_t k = 0; k < group.count; ++k) {
    const float unmeasured = partly_unknown ? known(static_cast<std::uint32_t>(labels.size() - 1), k) : 0.0f;
    if (1.0f - unmeasured < kMeasured && weight[k] < kNearSlices) {
      ++unseen;
      continue;
    }
    const auto share = [&](Label label) {
      const auto slot = std::lower_bound(labels.begin(), labels.end(), label);
      const auto row = std::lower_bound(near.labels.begin(), near.labels.end(), label);
      const float measured =
          slot != labels.end() && *slot == label ? known(static_cast<std::uint32_t>(slot - labels.begin()), k) : 0.0f;
      const float filled = row != near.labels.end() && *row == label
                               ? near.share[static_cast<std::size_t>(row - near.labels.begin()) * group.count + k]
                               : 0.0f;
      return measured + unmeasured * filled;
    };
    const Label said = label_[group.first + k];
    const float of_said = share(said);
    const auto beats = [&](Label label) {
      return label != said && label != kUnknown && (label < said ? share(label) >= of_said : share(label) > of_said);
    };
    if (std::any_of(labels.begin(), labels.end(), beats) || std::any_of(near.labels.begin(), near.labels.end(), beats))
      ++differ;
  }
  const double h = background.spacing_mm(), point_mm2 = kRaster * kRaster * h * h;
  if (point_mm2 * static_cast<double>(differ) >= kDiffers * h * h) return kWidth * h;
  const double seen_mm2 = point_mm2 * group.count;
  if (point_mm2 * static_cast<double>(unseen) >= kUnseenShare * seen_mm2 + kUnseen * h * h) return kUnseenWidth * h;
  return kLeaveWhole;
}

Result<CellAdmission::Widths> CellAdmission::judge(const Section& section, const CellComplex& cells,
                                                   const Background& background, FieldEvaluator& evaluator,
                                                   int threads) {
  raster(section, cells, kRaster * background.spacing_mm());
  pack(cells);
  if (const auto done = evaluator.evaluate(batch_); !done) return tl::unexpected<Error>(done.error());
  std::vector<double> width_mm(groups_.size());
  parallel_for(groups_.size(), 4, threads, [&](std::size_t first, std::size_t last) {
    const auto scratch = scratches_.take();
    for (std::size_t g = first; g < last; ++g) width_mm[g] = width(groups_[g], background, *scratch);
  });
  Widths widths;
  for (std::size_t g = 0; g < groups_.size(); ++g)
    if (width_mm[g] < kLeaveWhole) widths.emplace(groups_[g].cell, width_mm[g]);
  return widths;
}

}  // namespace sonoloft
