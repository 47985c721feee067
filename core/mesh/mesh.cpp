#include "core/mesh/mesh.h"

#include <bit>

namespace sonoloft {
namespace {

/// Numbers vertices by key in the order they come.
class KeyTable {
 public:
  explicit KeyTable(std::size_t most_keys)
      : shift_(64 - static_cast<int>(std::bit_width(2 * most_keys + 1))),
        slots_(std::size_t{1} << (64 - shift_), Slot{0, kFree}) {}

  /// The number of a key: `next` if it was not seen before.
  std::uint32_t number(std::uint64_t key, std::uint32_t next) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ull) >> shift_);
    while (slots_[at].number != kFree && slots_[at].key != key) at = (at + 1) & mask;
    if (slots_[at].number == kFree) slots_[at] = {key, next};
    return slots_[at].number;
  }

 private:
  static constexpr std::uint32_t kFree = 0xFFFFFFFF;
  struct Slot {
    std::uint64_t key;
    std::uint32_t number;
  };
  int shift_;
  std::vector<Slot> slots_;
};

}  // namespace

IndexedMesh MeshSnapshot::indexed() const {
  std::size_t vertices = 0, triangles = 0;
  for (const auto& chunk : chunks) {
    vertices += chunk->positions.size();
    triangles += chunk->triangles.size();
  }
  IndexedMesh mesh;
  mesh.positions.reserve(vertices);
  mesh.triangles.reserve(triangles);
  mesh.label_front.reserve(triangles);
  mesh.label_back.reserve(triangles);
  KeyTable table(vertices);
  std::vector<std::uint32_t> joined;
  for (const auto& chunk : chunks) {
    joined.resize(chunk->positions.size());
    for (std::size_t i = 0; i < joined.size(); ++i) {
      const auto next = static_cast<std::uint32_t>(mesh.positions.size());
      joined[i] = table.number(chunk->vertex_keys[i], next);
      if (joined[i] == next) mesh.positions.push_back(chunk->positions[i]);
    }
    for (const auto& [a, b, c] : chunk->triangles) mesh.triangles.push_back({joined[a], joined[b], joined[c]});
    mesh.label_front.insert(mesh.label_front.end(), chunk->label_front.begin(), chunk->label_front.end());
    mesh.label_back.insert(mesh.label_back.end(), chunk->label_back.begin(), chunk->label_back.end());
  }
  return mesh;
}

}  // namespace sonoloft
