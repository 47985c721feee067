#include "host/view/scene/bricks.h"

#include <iterator>
#include <utility>
#include <vector>

namespace sonoloft::view {

void Bricks::take(MeshSnapshot mesh) {
  ++meshes_;
  const MeshSnapshot before = std::exchange(mesh_, std::move(mesh));
  auto old = before.chunks.begin();
  auto now = mesh_.chunks.begin();
  while (old != before.chunks.end() || now != mesh_.chunks.end()) {
    if (now == mesh_.chunks.end() || (old != before.chunks.end() && (*old)->coord < (*now)->coord)) {
      change((*old++)->coord, nullptr);
    } else if (old == before.chunks.end() || (*now)->coord < (*old)->coord) {
      change((*now)->coord, *now);
      ++now;
    } else {
      if (*old++ != *now) change((*now)->coord, *now);
      ++now;
    }
  }
}

void Bricks::change(const BrickCoord& coord, std::shared_ptr<const MeshChunk> chunk) {
  Brick& brick = bricks_[coord];
  if (brick.chunk) {
    faces_ -= faces_of(*brick.chunk);
    triangles_ -= brick.chunk->triangles.size();
  }
  if (chunk) {
    faces_ += faces_of(*chunk);
    triangles_ += chunk->triangles.size();
  }
  brick.chunk = std::move(chunk);
  for (int i = 0; i < 27; ++i) {
    const BrickCoord beside{coord.x + i % 3 - 1, coord.y + i / 3 % 3 - 1, coord.z + i / 9 - 1};
    const auto found = bricks_.find(beside);
    if (found != bricks_.end() && (found->second.chunk || beside == coord)) touch(beside, found->second);
  }
}

void Bricks::touch(const BrickCoord& coord, Brick& brick) {
  by_version_.erase(brick.version);
  brick.version = ++version_;
  brick.bytes.clear();
  by_version_.emplace(brick.version, coord);
}

Neighbours Bricks::around(const BrickCoord& coord) const {
  Neighbours all{};
  for (int i = 0; i < 27; ++i) {
    const auto found = bricks_.find({coord.x + i % 3 - 1, coord.y + i / 3 % 3 - 1, coord.z + i / 9 - 1});
    if (found != bricks_.end()) all[static_cast<std::size_t>(i)] = found->second.chunk.get();
  }
  return all;
}

void Bricks::encode(const BrickCoord& coord, Brick& brick, const Confidence& sure) {
  brick.bytes.clear();
  brick.measured_at = 0;
  append_brick(coord, brick.chunk.get(), around(coord), sure, brick.bytes);
}

/// One question about all bricks that a viewer lacks next: each waits for a scan that is busy.
void Bricks::ask_confidence(std::uint64_t seen) {
  std::vector<Eigen::Vector3f> points;
  std::vector<BrickCoord> asked;
  for (auto next = by_version_.upper_bound(seen); next != by_version_.end() && points.size() < kPointsAsked; ++next) {
    const Brick& brick = bricks_.at(next->second);
    if (!brick.lacks_confidence()) continue;
    points.insert(points.end(), brick.chunk->positions.begin(), brick.chunk->positions.end());
    asked.push_back(next->second);
  }
  if (asked.empty()) return;
  const Confidence all = confidence_(points);
  auto measured = all.measured.begin();
  auto distance = all.distance_mm.begin();
  for (const BrickCoord& coord : asked) {
    Brick& brick = bricks_.at(coord);
    const auto count = std::ssize(brick.chunk->positions);
    encode(coord, brick, {{measured, measured + count}, {distance, distance + count}});
    brick.measured_at = meshes_;
    measured += count;
    distance += count;
  }
}

std::size_t Bricks::append_newer(std::uint64_t& seen, bool measured, std::size_t soft_limit, std::string& out) {
  if (measured) ask_confidence(seen);
  std::size_t count = 0;
  for (auto next = by_version_.upper_bound(seen); next != by_version_.end() && out.size() <= soft_limit; ++next) {
    Brick& brick = bricks_.at(next->second);
    if (measured && brick.lacks_confidence()) break;
    if (brick.bytes.empty()) encode(next->second, brick, {});
    out += brick.bytes;
    seen = next->first;
    ++count;
  }
  return count;
}

/// The brick that waits longest, where its confidence is not that of this mesh: bricks are asked for in the order of
/// their versions, so those after it are no older.
Bricks::ByVersion::const_iterator Bricks::oldest() const {
  for (auto at = by_version_.begin(); at != by_version_.end(); ++at) {
    const Brick& brick = bricks_.at(at->second);
    if (brick.chunk) return brick.measured_at == meshes_ ? by_version_.end() : at;
  }
  return by_version_.end();
}

void Bricks::renew_confidence(std::size_t count) {
  for (; count > 0 && confidence_is_old(); --count) {
    const BrickCoord coord = oldest()->second;
    touch(coord, bricks_.at(coord));
  }
}

}  // namespace sonoloft::view
