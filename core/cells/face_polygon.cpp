#include "core/cells/face_polygon.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace sonoloft {
namespace {

/// Where an edge meets the line, walking along the line with the upper side on the left.
struct Crossing {
  double t;     ///< position along the line
  double lean;  ///< which way the edge leaves downwards: orders edges that meet in one point of the line
  Eigen::Vector2d point;
  Label before, after;  ///< labels of the face before and after the edge is crossed
};

Crossing cross(const FaceEdge& e, double sa, double sb, const Eigen::Vector2d& along) {
  const bool rises = sa < sb;
  const Eigen::Vector2d& low = rises ? e.a : e.b;
  const Eigen::Vector2d& high = rises ? e.b : e.a;
  const double s_low = rises ? sa : sb;
  const double s_high = rises ? sb : sa;
  Crossing c;
  // A point exactly on the line counts as above it; the edge then ends in that very point.
  c.point = s_high == 0.0 ? high : Eigen::Vector2d(low + (high - low) * (s_low / (s_low - s_high)));
  c.t = along.dot(c.point);
  c.lean = (along.dot(low) - c.t) / -s_low;
  c.before = rises ? e.left : e.right;
  c.after = rises ? e.right : e.left;
  return c;
}

/// Closes both parts along the line: pieces between the crossings, labelled by what the walk has met so far.
void close_along_line(std::vector<Crossing>& crossings, FacePolygon& below, FacePolygon& above) {
  if (crossings.empty()) return;
  std::sort(crossings.begin(), crossings.end(),
            [](const Crossing& l, const Crossing& r) { return std::tie(l.t, l.lean) < std::tie(r.t, r.lean); });
  const double tie = 1e-9 * (crossings.back().t - crossings.front().t);
  Label current = kBeyondFace;
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    // Rounding can swap crossings that all but coincide: take the one that continues the label we are in.
    for (std::size_t j = i; j < crossings.size() && crossings[j].t <= crossings[i].t + tie; ++j) {
      if (crossings[j].before != current) continue;
      std::rotate(crossings.begin() + static_cast<std::ptrdiff_t>(i),
                  crossings.begin() + static_cast<std::ptrdiff_t>(j),
                  crossings.begin() + static_cast<std::ptrdiff_t>(j) + 1);
      break;
    }
    if (current != kBeyondFace && crossings[i - 1].point != crossings[i].point) {
      above.push_back({crossings[i - 1].point, crossings[i].point, current, kBeyondFace});
      below.push_back({crossings[i].point, crossings[i - 1].point, current, kBeyondFace});
    }
    current = crossings[i].after;
  }
}

}  // namespace

std::pair<FacePolygon, FacePolygon> split(const FacePolygon& polygon, const ImageLine& line) {
  FacePolygon below, above;
  std::vector<Crossing> crossings;
  const Eigen::Vector2d along(line.normal.y(), -line.normal.x());
  for (const FaceEdge& e : polygon) {
    const double sa = line.distance(e.a);
    const double sb = line.distance(e.b);
    if (sa >= 0.0 && sb >= 0.0) {
      above.push_back(e);
    } else if (sa < 0.0 && sb < 0.0) {
      below.push_back(e);
    } else {
      const Crossing& c = crossings.emplace_back(cross(e, sa, sb, along));
      const FaceEdge first{e.a, c.point, e.left, e.right, e.source};
      const FaceEdge second{c.point, e.b, e.left, e.right, e.source};
      if (first.a != first.b) (sa < 0.0 ? below : above).push_back(first);
      if (second.a != second.b) (sb < 0.0 ? below : above).push_back(second);
    }
  }
  close_along_line(crossings, below, above);
  return {std::move(below), std::move(above)};
}

double area(const FacePolygon& polygon, Label label) {
  if (polygon.empty()) return 0.0;
  const Eigen::Vector2d origin = polygon.front().a;  // far from zero, areas would cancel
  double twice = 0.0;
  for (const FaceEdge& e : polygon) {
    const Eigen::Vector2d a = e.a - origin;
    const Eigen::Vector2d b = e.b - origin;
    const double term = a.x() * b.y() - a.y() * b.x();
    if (label == kBeyondFace) {
      if (e.right == kBeyondFace) twice += term;
    } else {
      if (e.left == label) twice += term;
      if (e.right == label) twice -= term;
    }
  }
  return 0.5 * twice;
}

bool has_unknown(const FacePolygon& polygon) {
  return std::any_of(polygon.begin(), polygon.end(),
                     [](const FaceEdge& e) { return e.left == kUnknown || e.right == kUnknown; });
}

}  // namespace sonoloft
