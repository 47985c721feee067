#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "core/slice/planar/planar_network.h"

using namespace sonoloft;

namespace {

std::vector<OwnedSegment> random_segments(std::mt19937& random, int count, std::int32_t side, std::int32_t offset) {
  std::uniform_int_distribution<std::int32_t> coordinate(0, side);
  std::uniform_int_distribution<std::uint32_t> owner(0, 3);
  std::vector<OwnedSegment> segments;
  while (static_cast<int>(segments.size()) < count) {
    GridPoint a{offset + coordinate(random), offset + coordinate(random)};
    GridPoint b{offset + coordinate(random), offset + coordinate(random)};
    if (a == b) continue;
    if (b < a) std::swap(a, b);
    segments.push_back({a, b, owner(random)});
  }
  cancel_pairs(segments);
  return segments;
}

bool in_box(const OwnedSegment& s, GridPoint p) {
  const auto [low, high] = std::minmax(s.a.y, s.b.y);
  return s.a.x <= p.x && p.x <= s.b.x && low <= p.y && p.y <= high;
}

int sign(std::int64_t v) {
  return (v > 0) - (v < 0);
}

/// Do two different segments share a point that is not an end of both?
bool meet_badly(const OwnedSegment& s, const OwnedSegment& t) {
  for (const GridPoint p : {t.a, t.b})
    if (p != s.a && p != s.b && in_box(s, p) && orient(s.a, s.b, p) == 0) return true;
  for (const GridPoint p : {s.a, s.b})
    if (p != t.a && p != t.b && in_box(t, p) && orient(t.a, t.b, p) == 0) return true;
  return sign(orient(s.a, s.b, t.a)) * sign(orient(s.a, s.b, t.b)) < 0 &&
         sign(orient(t.a, t.b, s.a)) * sign(orient(t.a, t.b, s.b)) < 0;
}

int bad_meetings(const std::vector<OwnedSegment>& segments) {
  int bad = 0;
  for (std::size_t i = 0; i < segments.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const bool same = segments[i].a == segments[j].a && segments[i].b == segments[j].b;
      bad += same ? segments[i].owner == segments[j].owner : meet_badly(segments[i], segments[j]);
    }
  return bad;
}

/// Every owner's segments bound something exactly when every point has an even number of them.
std::vector<OwnedSegment> odd_ends(const std::vector<OwnedSegment>& segments) {
  std::vector<OwnedSegment> ends;
  for (const OwnedSegment& s : segments) {
    ends.push_back({s.a, s.a, s.owner});
    ends.push_back({s.b, s.b, s.owner});
  }
  cancel_pairs(ends);
  return ends;
}

}  // namespace

TEST_CASE("split: on grids so coarse that everything touches, pieces meet in common ends only") {
  std::mt19937 random(7);
  std::size_t in = 0, out = 0;
  std::uint32_t crossings = 0;
  for (int round = 0; round < 1200; ++round) {
    const std::int32_t side = 3 + round % 60;
    auto segments = random_segments(random, 3 + round % 40, side, round % 2 ? 0 : (1 << 30) - side);
    const auto ends = odd_ends(segments);
    in += segments.size();
    const SplitResult result = split_at_crossings(segments, 9);
    crossings += result.crossings;
    out += segments.size();
    REQUIRE_FALSE(result.too_tangled);
    REQUIRE_MESSAGE(bad_meetings(segments) == 0, "round ", round);
    REQUIRE_MESSAGE(odd_ends(segments) == ends, "round ", round);
  }
  MESSAGE(in, " segments became ", out, ", split at ", crossings, " crossings");
  CHECK(crossings > 40000);
}

TEST_CASE("split: across the whole grid and in bundles of nearly parallel lines, pieces meet in common ends only") {
  std::mt19937 random(8);
  for (int round = 0; round < 40; ++round) {
    auto segments = random_segments(random, 60, 1 << 30, 0);
    for (int k = 0; k < 60; ++k) {  // a bundle one step wide
      const std::int32_t y = static_cast<std::int32_t>(random() % 6), z = static_cast<std::int32_t>(random() % 6);
      segments.push_back({{static_cast<std::int32_t>(random() % 6), y},
                          {(1 << 30) - static_cast<std::int32_t>(random() % 6), (1 << 29) + z},
                          static_cast<std::uint32_t>(random() % 4)});
    }
    cancel_pairs(segments);
    const auto ends = odd_ends(segments);
    REQUIRE_FALSE(split_at_crossings(segments, 9).too_tangled);
    REQUIRE_MESSAGE(bad_meetings(segments) == 0, "round ", round);
    REQUIRE(odd_ends(segments) == ends);
  }
}
