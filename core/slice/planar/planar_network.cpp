#include "core/slice/planar/planar_network.h"

#include <algorithm>
#include <tuple>

#include "core/slice/planar/segment_tree.h"

namespace sonoloft {
namespace {

__extension__ typedef __int128 Int128;

/// The distinct segments of a sorted list: segment i is that of the records first[i] up to first[i + 1].
struct Distinct {
  std::vector<GridSegment> segments;
  std::vector<std::size_t> first;
};

Distinct distinct(const std::vector<OwnedSegment>& records) {
  Distinct out;
  out.segments.reserve(records.size());
  out.first.reserve(records.size() + 1);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const GridSegment s{records[i].a, records[i].b};
    if (!out.segments.empty() && out.segments.back() == s) continue;
    out.segments.push_back(s);
    out.first.push_back(i);
  }
  out.first.push_back(records.size());
  return out;
}

bool inside_box(const GridSegment& s, GridPoint p) {
  const auto [low, high] = std::minmax(s.a.y, s.b.y);
  return s.a.x <= p.x && p.x <= s.b.x && low <= p.y && p.y <= high && p != s.a && p != s.b;
}

/// Does the segment, other than with its own ends, meet the pixel [x - 1/2, x + 1/2) x [y - 1/2, y + 1/2) of p?
/// Both ends are middles of pixels: where p lies in the segment's box, the segment meets p's pixel if its line does.
bool meets_pixel(const GridSegment& s, GridPoint p) {
  if (!inside_box(s, p)) return false;
  const std::int64_t dx = std::int64_t{s.b.x} - s.a.x, dy = std::int64_t{s.b.y} - s.a.y;
  const std::int64_t offset = 2 * orient(s.a, s.b, p), reach = dx + std::abs(dy);
  // A line that only touches the pixel touches it in a corner; the lower left one alone belongs to the pixel.
  return std::abs(offset) < reach || (dy < 0 && offset == reach);
}

bool opposite(std::int64_t u, std::int64_t v) {
  return (u < 0 && v > 0) || (u > 0 && v < 0);
}

bool cross_properly(const GridSegment& s, const GridSegment& t) {
  return opposite(orient(s.a, s.b, t.a), orient(s.a, s.b, t.b)) &&
         opposite(orient(t.a, t.b, s.a), orient(t.a, t.b, s.b));
}

/// The pixel that the crossing of s and t lies in.
GridPoint crossing_pixel(const GridSegment& s, const GridSegment& t) {
  Int128 part = orient(s.a, s.b, t.a), whole = part - orient(s.a, s.b, t.b);
  if (whole < 0) part = -part, whole = -whole;
  const auto along = [&](std::int32_t from, std::int32_t to) {  // both terms of the quotient are positive
    const Int128 twice = 2 * (from * whole + (std::int64_t{to} - from) * part) + whole;
    return static_cast<std::int32_t>(twice / (2 * whole));
  };
  return {along(t.a.x, t.b.x), along(t.a.y, t.b.y)};
}

struct Cut {
  std::uint32_t segment;
  GridPoint at;
};

/// Where segments are to be cut.
class Cuts {
 public:
  explicit Cuts(const Distinct& in) : in_(in) {}

  void add_if_met(std::uint32_t segment, GridPoint p) {
    if (!meets_pixel(in_.segments[segment], p)) return;
    list_.push_back({segment, p});
    added_pieces_ += in_.first[segment + 1] - in_.first[segment];  // one for each owner
  }
  bool within_limit() const { return added_pieces_ <= kMaxAddedPieces; }
  bool empty() const { return list_.empty(); }

  /// The cuts of every segment, one segment after the other, in the order in which it meets them: by x, then by y
  /// upwards or downwards as the segment goes.
  const std::vector<Cut>& sorted() {
    const auto key = [&](const Cut& c) {
      const GridSegment& s = in_.segments[c.segment];
      return std::tuple(c.segment, c.at.x, s.b.y >= s.a.y ? c.at.y : -c.at.y);
    };
    std::sort(list_.begin(), list_.end(), [&](const Cut& c, const Cut& d) { return key(c) < key(d); });
    return list_;
  }

 private:
  const Distinct& in_;
  std::vector<Cut> list_;
  std::size_t added_pieces_ = 0;
};

struct Crossing {
  GridPoint at;
  bool counts;
};

/// Ends of segments in the pixels that other segments meet, and the pixels in which segments cross.
/// @returns false when a limit was met
bool find_meetings(const Distinct& in, const SegmentTree& tree, Cuts& cuts, std::vector<Crossing>& crossings,
                   const auto& counted) {
  return tree.visit_pairs(kMaxBoxTests, [&](std::uint32_t i, std::uint32_t j) {
    const GridSegment &s = in.segments[i], &t = in.segments[j];
    for (const GridPoint p : {t.a, t.b}) cuts.add_if_met(i, p);
    for (const GridPoint p : {s.a, s.b}) cuts.add_if_met(j, p);
    if (cross_properly(s, t)) crossings.push_back({crossing_pixel(s, t), counted(i) && counted(j)});
    return cuts.within_limit() && crossings.size() <= kMaxCrossings;
  });
}

/// Every segment is to go through the middle of every pixel that it meets and that holds an end or a crossing. Then no
/// segment has moved across an end, and no two cross (Hobby's theorem). Nor does a piece from one middle to the next go
/// through a third one: each of its points is within half a step, in x and in y, of a point of the segment that it came
/// from, which so would have met the third one's pixel.
/// @returns false when a limit was met
bool find_cuts(const Distinct& in, Cuts& cuts, std::uint32_t& crossing_count, const auto& counted) {
  const SegmentTree tree(in.segments);
  std::vector<Crossing> crossings;
  if (!find_meetings(in, tree, cuts, crossings, counted)) return false;
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& c, const Crossing& d) {
    return std::tuple(c.at, d.counts) < std::tuple(d.at, c.counts);  // of one point, those that count come first
  });
  const auto same_point = [](const Crossing& c, const Crossing& d) { return c.at == d.at; };
  crossings.erase(std::unique(crossings.begin(), crossings.end(), same_point), crossings.end());
  for (const Crossing& crossing : crossings) {
    crossing_count += crossing.counts;
    const bool within_limit = tree.visit_containing(crossing.at, [&](std::uint32_t i) {
      cuts.add_if_met(i, crossing.at);
      return cuts.within_limit();
    });
    if (!within_limit) return false;
  }
  return true;
}

/// Replaces every cut segment by the chain through its cuts, for each of its owners.
std::vector<OwnedSegment> pieces_of(const std::vector<OwnedSegment>& records, const Distinct& in,
                                    const std::vector<Cut>& cuts) {
  std::vector<OwnedSegment> pieces;
  pieces.reserve(records.size() + cuts.size());
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < in.segments.size(); ++i) {
    GridPoint from = in.segments[i].a;
    const auto add_piece = [&](GridPoint to) {
      if (from == to) return;
      const auto [a, b] = std::minmax(from, to);
      for (std::size_t r = in.first[i]; r < in.first[i + 1]; ++r) pieces.push_back({a, b, records[r].owner});
      from = to;
    };
    for (; next < cuts.size() && cuts[next].segment == i; ++next) add_piece(cuts[next].at);
    add_piece(in.segments[i].b);
  }
  return pieces;
}

}  // namespace

void cancel_pairs(std::vector<OwnedSegment>& segments) {
  std::sort(segments.begin(), segments.end());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < segments.size();) {
    std::size_t end = i + 1;
    while (end < segments.size() && segments[end] == segments[i]) ++end;
    if ((end - i) % 2 == 1) segments[kept++] = segments[i];
    i = end;
  }
  segments.resize(kept);
}

SplitResult split_at_crossings(std::vector<OwnedSegment>& segments, std::uint32_t uncounted_owner) {
  SplitResult result;
  const Distinct in = distinct(segments);
  Cuts cuts(in);
  const auto counted = [&](std::uint32_t i) { return segments[in.first[i]].owner != uncounted_owner; };
  result.too_tangled = !find_cuts(in, cuts, result.crossings, counted);
  if (result.too_tangled || cuts.empty()) return result;
  segments = pieces_of(segments, in, cuts.sorted());
  cancel_pairs(segments);
  return result;
}

}  // namespace sonoloft
