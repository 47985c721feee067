#include "core/mesh/vertices/label_rows.h"

#include <algorithm>
#include <cstring>

namespace sonoloft {
namespace {

constexpr unsigned kWholeRow = (1u << BlockGrid::kSide) - 1;
constexpr unsigned kCells = (1u << kBrickSize) - 1;

/// The bits of a byte as eight bytes, each 0 or 1, the lowest first.
constexpr auto kBytes = [] {
  std::array<std::uint64_t, 256> bytes{};
  for (unsigned bits = 0; bits < 256; ++bits)
    for (unsigned i = 0; i < 8; ++i) bytes[bits] |= std::uint64_t{bits >> i & 1} << (8 * i);
  return bytes;
}();

/// Eight bytes, each 0 or 1, as the bits of one, the lowest first.
unsigned bits_of(const std::uint8_t* bytes) {
  static_assert(std::endian::native == std::endian::little);
  std::uint64_t all = 0;
  std::memcpy(&all, bytes, sizeof(all));
  return static_cast<unsigned>(all * 0x0102040810204080ull >> 56);
}

}  // namespace

void LabelRows::read(const BlockLabels& labels) {
  labels_.clear();
  Rows seen{};
  for (std::size_t row = 0; row < seen.size(); ++row)
    while (seen[row] != kWholeRow) {
      const auto x = static_cast<std::size_t>(std::countr_one(seen[row]));
      add(labels[row * BlockGrid::kSide + x], labels);
      for (std::size_t i = 0; i < seen.size(); ++i) seen[i] |= labels_.back().rows[i];
    }
  std::ranges::sort(labels_, {}, &OneLabel::label);
  mixed_.fill(0);
  corners_.fill(0);
  if (labels_.size() < 2) return;
  for (int z = 0; z < kBrickSize; ++z)
    for (int y = 0; y < kBrickSize; ++y) {
      const std::size_t row = row_of(y, z);
      const unsigned mixed = mixed_in(row);
      mixed_[row] = static_cast<std::uint16_t>(mixed);
      for (const std::size_t beside : kBetween)
        corners_[row + beside] |= static_cast<std::uint16_t>(mixed | mixed << 1);
    }
}

void LabelRows::add(Label label, const BlockLabels& labels) {
  std::array<std::uint8_t, BlockGrid::kPoints> equal;
  for (std::size_t i = 0; i < equal.size(); ++i) equal[i] = labels[i] == label ? 1 : 0;
  OneLabel& added = labels_.emplace_back();
  added.label = label;
  for (std::size_t row = 0; row < added.rows.size(); ++row) {
    const std::uint8_t* bytes = equal.data() + row * BlockGrid::kSide;
    added.rows[row] =
        static_cast<std::uint16_t>(bits_of(bytes) | static_cast<unsigned>(bytes[kBrickSize]) << kBrickSize);
  }
}

unsigned LabelRows::mixed_in(std::size_t row) const {
  static_assert(kNotSampled > kMaxLabel);
  unsigned mixed = 0;
  for (const OneLabel& one : labels_) {
    unsigned any = 0, all = kWholeRow;
    for (const std::size_t beside : kBetween) {
      any |= one.rows[row + beside];
      all &= one.rows[row + beside];
    }
    any |= any >> 1;
    if (one.label == kNotSampled)
      mixed &= ~any;
    else
      mixed |= any & ~(all & all >> 1);
  }
  return mixed & kCells;
}

void LabelRows::find_labels(std::size_t row, int x, CellSamples& cell) const {
  std::size_t count = 0;
  std::uint64_t owners = 0;
  for (const OneLabel& one : labels_) {
    unsigned corners = 0;
    for (std::size_t i = 0; i < 4; ++i) corners |= (one.rows[row + kBetween[i]] >> x & 3u) << (2 * i);
    if (corners == 0) continue;
    owners |= count * kBytes[corners];
    cell.label[count] = one.label;
    cell.corners[count++] = static_cast<std::uint8_t>(corners);
  }
  cell.label_count = static_cast<int>(count);
  std::memcpy(cell.owner.data(), &owners, sizeof(owners));
}

}  // namespace sonoloft
