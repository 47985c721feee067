#include "core/methods/straight_skeleton/patch/patch_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sonoloft::skeleton {
namespace {

using Eigen::Vector2d;

/// Of a slice's extent: four steps of the grid that make_section() puts points on.
constexpr double kGrid = 0x1p-28;
/// Of a slice's extent: what a rough coordinate must differ by to be sure.
constexpr double kSure = 1e-11;

double turning(const Vector2d& from, const Vector2d& to) {
  return std::atan2(from.x() * to.y() - from.y() * to.x(), from.dot(to));
}

double distance_from(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d way = b - a;
  const double t = std::clamp((p - a).dot(way) / way.squaredNorm(), 0.0, 1.0);
  return (p - a - t * way).norm();
}

}  // namespace

PatchMap::PatchMap(const Section& section, const Image& of) : image(of), border_(section.border) {
  bounded = section.border == kUnknown;
  for (const Vector2d& p : section.points) spots.emplace_back(p);
  find_rims(section);
  for (const SectionEdge& e : section.edges)
    edges.push_back({e.a, e.b, e.left, e.right, image.line(spots[e.a], spots[e.b])});
}

void PatchMap::find_rims(const Section& section) {
  Eigen::AlignedBox2d box;
  for (const Vector2d& p : section.points) box.extend(p);
  if (box.isEmpty()) return;
  doubt_mm_ = kSure * (box.sizes().maxCoeff() + box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff());
  struct Way {
    std::uint32_t to;
    bool used = false;
  };
  std::vector<std::vector<Way>> from(section.points.size());
  for (const SectionEdge& e : section.edges) {
    if (e.right == kUnknown) from[e.a].push_back({e.b});
    if (e.left == kUnknown) from[e.b].push_back({e.a});
  }
  for (std::uint32_t start = 0; start < from.size(); ++start)
    for (Way& first : from[start]) {
      std::vector<std::uint32_t> loop;
      std::uint32_t at = start;
      for (Way* way = &first; !way->used;) {
        way->used = true;
        loop.push_back(at);
        const Vector2d direction = section.points[way->to] - section.points[at];
        at = way->to;
        way = &*std::ranges::max_element(from[at], {}, [&](const Way& w) {
          return w.used && &w != &first ? -10 : turning(direction, section.points[w.to] - section.points[at]);
        });
      }
      if (loop.empty()) continue;
      straighten(loop, kGrid * box.sizes().maxCoeff());
      rims.push_back(std::move(loop));
    }
}

void PatchMap::straighten(std::vector<std::uint32_t>& loop, double tolerance_mm) {
  const auto lowest = std::ranges::min_element(loop, {}, [&](std::uint32_t s) {
    return std::pair{spots[s].rough.x(), spots[s].rough.y()};
  });
  std::rotate(loop.begin(), lowest, loop.end());
  const std::size_t n = loop.size();
  const auto at = [&](std::size_t i) -> Spot& { return spots[loop[i % n]]; };
  const auto is_straight = [&](std::size_t i, std::size_t k) {
    for (std::size_t m = i + 1; m < k; ++m)
      if (distance_from(at(m).rough, at(i).rough, at(k).rough) > tolerance_mm) return false;
    return true;
  };
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < n;) {
    std::size_t k = i + 1;
    while (k < n && is_straight(i, k + 1)) ++k;
    const Vector2d from = at(i).rough, way = at(k).rough - from;
    for (std::size_t m = i + 1; m < k; ++m)
      at(m) = between(at(i), at(k), Exact((at(m).rough - from).dot(way) / way.squaredNorm()));
    kept.push_back(loop[i]);
    i = k;
  }
  loop = std::move(kept);
}

Label PatchMap::label_at(const Corner& p, const Eigen::Vector3d& towards) const {
  const Vector2d near = image.foot(p), way = image.direction(towards);
  const auto is_before = [&](const Spot& q) {
    const double by_mm = near.x() - q.rough.x();
    if (std::abs(by_mm) > doubt_mm_) return by_mm > 0;
    const int side = image.compare_x(p, q);
    return side != 0 ? side > 0 : way.x() >= 0;
  };
  int label = border_;
  for (const Edge& edge : edges) {  // what is met on the way down to the point, in any order
    const Spot &a = spots[edge.a], &b = spots[edge.b];
    if (near.y() > std::max(a.rough.y(), b.rough.y()) + doubt_mm_) continue;
    const bool a_before = is_before(a);
    if (a_before == is_before(b)) continue;
    int side = side_of(*edge.line, p, doubt_mm_);
    if (side == 0) side = edge.line->rough.head<3>().dot(towards) > 0 ? 1 : -1;
    if (a_before ? side < 0 : side > 0) label += (a_before ? 1 : -1) * (int{edge.right} - int{edge.left});
  }
  return static_cast<Label>(label);
}

PatchMap::Run PatchMap::labels_along(const Spot& a, const Spot& b) const {
  struct Place {
    Exact t;
    Spot spot;
  };
  const bool by_x = std::abs(b.rough.x() - a.rough.x()) > std::abs(b.rough.y() - a.rough.y());
  const auto place_of = [&](const Spot& p) { return by_x ? (p.x - a.x) / (b.x - a.x) : (p.y - a.y) / (b.y - a.y); };
  std::vector<Place> places{{Exact(0), a}, {Exact(1), b}};
  for (const Edge& edge : edges) {
    const Spot &p = spots[edge.a], &q = spots[edge.b];
    const int at_p = turn(a, b, p), at_q = turn(a, b, q);
    if (at_p == 0) places.push_back({place_of(p), p});
    if (at_q == 0) places.push_back({place_of(q), q});
    if (at_p * at_q < 0) {
      const Exact t = cross(a, p, p, q) / cross(a, b, p, q);
      places.push_back({t, between(a, b, t)});
    }
  }
  std::erase_if(places, [](const Place& p) { return sign_of(p.t) < 0 || sign_of(Exact(1) - p.t) < 0; });
  std::ranges::sort(places, [](const Place& p, const Place& q) { return sign_of(p.t - q.t) < 0; });
  Run run;
  const Vector2d left(a.rough.y() - b.rough.y(), b.rough.x() - a.rough.x());
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    if (sign_of(places[i + 1].t - places[i].t) == 0) continue;
    const Spot middle = between(places[i].spot, places[i + 1].spot, Exact(0.5));
    const Label label = label_at(image.place(middle), image.direction(left));
    if (!run.labels.empty() && run.labels.back() == label) continue;
    if (!run.labels.empty()) run.changes.push_back(places[i].spot);
    run.labels.push_back(label);
  }
  return run;
}

}  // namespace sonoloft::skeleton
