#include "core/octree/sampled_cells.h"

#include <array>
#include <optional>
#include <utility>

#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

/// Piles that the cells are packed in, side by side: some for each thread, since cells differ in size.
constexpr std::size_t kPiles = 16;

}  // namespace

SampledCells::SampledCells(const CellComplex& cells, const ContourSlopes* slopes, const UnmeasuredFill& fill)
    : cells_(cells), slopes_(slopes), fill_(fill), index_(cells.cell_bound(), kNotKnown) {}

std::uint32_t SampledCells::find_or_add(CellId cell) {
  std::uint32_t& index = index_[static_cast<std::size_t>(cell)];
  if (index == kNotKnown) {
    index = static_cast<std::uint32_t>(known_.size());
    known_.push_back({cell, {}, {}});
  }
  return index;
}

void SampledCells::pack(PackedCells& packed, int threads) {
  const std::span<Known> added = std::span(known_).subspan(packed.size());
  std::array<PackedCells, kPiles> piles;
  parallel_for(kPiles, 1, threads, [&](std::size_t first, std::size_t last) {
    Scratch scratch;
    for (std::size_t pile = first; pile < last; ++pile)
      for (std::size_t i = added.size() * pile / kPiles; i < added.size() * (pile + 1) / kPiles; ++i)
        pack(added[i], scratch, piles[pile]);
  });
  for (PackedCells& pile : piles) packed.append(std::exchange(pile, {}));
}

void SampledCells::pack(Known& known, Scratch& scratch, PackedCells& out) const {
  cells_.faces(known.cell, scratch.faces);
  const Eigen::AlignedBox3d bounds = cells_.bounds(known.cell);
  scratch.apart.clear();
  for (std::uint32_t i = 0; fill_.rim && i < scratch.faces.size(); ++i)
    if (const Rim* rim = rim_at(scratch.faces[i], bounds)) {
      scratch.apart.push_back(i);
      known.rims.push_back(rim);
    }
  scratch.bends.clear();
  for (const CellFace& face : scratch.faces) {
    const std::optional<SliceId> slice = slopes_ == nullptr ? std::nullopt : cells_.slice_of(face.plane);
    scratch.bends.push_back(slice ? FaceBends{&cells_.section(*slice), slopes_->bends(*slice)} : FaceBends{});
  }
  out.add(scratch.faces, cells_.centre(known.cell), scratch.apart, scratch.bends);
  for (const CellFace& face : scratch.faces) {
    if (!cells_.slice_of(face.plane) || face.label == kUnknown) continue;
    const Eigen::Vector3d normal = face.image_to_reference->linear().col(2);
    known.pins.push_back({normal, -normal.dot(face.image_to_reference->translation())});
  }
}

/// The rim that says something about the unknown part of a face of a cell, or null.
const Rim* SampledCells::rim_at(const CellFace& face, const Eigen::AlignedBox3d& cell) const {
  const std::optional<SliceId> slice = cells_.slice_of(face.plane);
  if (!slice || !has_unknown(*face.polygon)) return nullptr;
  const Rim& rim = fill_.rim(*slice);
  return rim.reaches(cell.center(), 0.5 * cell.diagonal().norm()) ? &rim : nullptr;
}

}  // namespace sonoloft
