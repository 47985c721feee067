#include "core/mesh/vertices/sample_block.h"

#include <algorithm>
#include <bit>

namespace sonoloft {
namespace {

/// Rows of fixed length, so that each is a few plain moves.
template <int kLength, class T>
void copy_rows(int ny, int nz, const T* source, T absent, T* target) {
  for (int z = 0; z < nz; ++z) {
    for (int y = 0; y < ny; ++y) {
      T* row = target + SampleBlock::index(0, y, z);
      if (source)
        std::copy_n(source + sample_index(0, y, z), kLength, row);
      else
        std::fill_n(row, kLength, absent);
    }
  }
}

/// Copies the part of one value per sample that a brick contributes: `source` is null where it contributes `absent`.
/// Brick `which` is on the upper side in x, y, z where bit 0, 1, 2 is set, and gives one layer there.
template <class T>
void copy_part(unsigned which, const T* source, T absent, T* block) {
  const LocalPoint upper = corner_of({0, 0, 0}, which);
  const int ny = upper.y ? 1 : kBrickSize, nz = upper.z ? 1 : kBrickSize;
  T* target = block + SampleBlock::index(upper.x * kBrickSize, upper.y * kBrickSize, upper.z * kBrickSize);
  if (upper.x)
    copy_rows<1>(ny, nz, source, absent, target);
  else
    copy_rows<kBrickSize>(ny, nz, source, absent, target);
}

}  // namespace

void CellSamples::sort_labels(const std::array<Label, 8>& corner_labels) {
  label_count = 0;
  for (unsigned rest = 0xFF; rest != 0;) {
    const Label next = corner_labels[static_cast<std::size_t>(std::countr_zero(rest))];
    unsigned having = 0;
    for (unsigned c = 0; c < 8; ++c) having |= (corner_labels[c] == next ? 1u : 0u) << c;
    rest &= ~having;
    auto at = static_cast<std::size_t>(label_count++);
    for (; at > 0 && label[at - 1] > next; --at) {
      label[at] = label[at - 1];
      corners[at] = corners[at - 1];
    }
    label[at] = next;
    corners[at] = static_cast<std::uint8_t>(having);
  }
  owner.fill(0);
  for (std::size_t i = 1; i < static_cast<std::size_t>(label_count); ++i)
    for (unsigned c = 0; c < 8; ++c) owner[c] = static_cast<std::uint8_t>((corners[i] >> c & 1) != 0 ? i : owner[c]);
}

void SampleBlock::select(const SampleLattice& lattice, const BrickCoord& coord) {
  planes_of_.clear();
  for (unsigned which = 0; which < 8; ++which) {
    const LocalPoint at = corner_of({0, 0, 0}, which);
    bricks_[which] = lattice.find({coord.x + at.x, coord.y + at.y, coord.z + at.z});
    const Brick* brick = bricks_[which];
    copy_part(which, brick ? brick->label.data() : nullptr, kNotSampled, labels_.data());
    copy_part(which, brick && !brick->slice_steps.empty() ? brick->slice_steps.data() : nullptr, kFarFromSlices,
              slice_steps_.data());
  }
}

void SampleBlock::cell_labels(LocalPoint cell, CellSamples& samples) const {
  const Label* lowest = labels_.data() + index(cell.x, cell.y, cell.z);
  std::array<Label, 8> corners;
  for (std::size_t c = 0; c < 8; ++c) corners[c] = lowest[kCorner[c]];
  samples.sort_labels(corners);
}

void SampleBlock::cell_shares(LocalPoint cell, CellSamples& samples) {
  const float* lowest_steps = slice_steps_.data() + index(cell.x, cell.y, cell.z);
  for (std::size_t c = 0; c < 8; ++c) samples.slice_steps[c] = lowest_steps[kCorner[c]];
  for (std::size_t i = 0; i < static_cast<std::size_t>(samples.label_count); ++i) {
    const float* lowest = plane_of(samples.label[i]) + index(cell.x, cell.y, cell.z);
    for (std::size_t c = 0; c < 8; ++c) samples.share[i][c] = lowest[kCorner[c]];
  }
}

const float* SampleBlock::plane_of(Label label) {
  std::size_t plane = 0;
  while (plane < planes_of_.size() && planes_of_[plane] != label) ++plane;
  if (plane == planes_of_.size()) {
    planes_of_.push_back(label);
    if (planes_.size() < (plane + 1) * kPoints) planes_.resize((plane + 1) * kPoints);
    read_plane(label, planes_.data() + plane * kPoints);
  }
  return planes_.data() + plane * kPoints;
}

void SampleBlock::read_plane(Label label, float* plane) const {
  for (unsigned which = 0; which < 8; ++which) {
    const float* source = nullptr;
    if (const Brick* brick = bricks_[which]) {
      const auto found = std::lower_bound(brick->palette.begin(), brick->palette.end(), label);
      if (found != brick->palette.end() && *found == label)
        source = brick->share.data() + (found - brick->palette.begin()) * kBrickSamples;
    }
    copy_part(which, source, 0.0F, plane);
  }
}

}  // namespace sonoloft
