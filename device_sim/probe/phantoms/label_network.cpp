#include "device_sim/probe/phantoms/label_network.h"

namespace sonoloft::device_sim {
std::uint32_t LabelNetwork::add_vertex(const Eigen::Vector2d& point) {
  vertices_.push_back({point, {}, 0});
  return static_cast<std::uint32_t>(vertices_.size() - 1);
}

void LabelNetwork::connect(std::uint32_t a, std::uint32_t b, Label left, Label right) {
  const auto along = static_cast<HalfEdge>(2 * segments_.size());
  segments_.push_back({a, b, left, right});
  vertices_[a].out[vertices_[a].degree++] = along;
  vertices_[b].out[vertices_[b].degree++] = along + 1;
}

void LabelNetwork::add_segment(std::uint32_t a, std::uint32_t b, Label left, Label right) {
  connect(a, b, left, right);
}

void LabelNetwork::add_junction(const Eigen::Vector2d& point, std::span<const std::uint32_t> ends,
                                std::span<const Label> after) {
  const std::uint32_t junction = add_vertex(point);
  for (std::size_t i = 0; i < ends.size(); ++i)
    connect(junction, ends[i], after[i], after[(i + ends.size() - 1) % ends.size()]);
}

LabelNetwork::HalfEdge LabelNetwork::next_around_region(HalfEdge h) const {
  const Vertex& v = vertices_[to(h)];
  std::uint32_t i = 0;
  while (v.out[i] != (h ^ 1)) ++i;
  return v.out[(i + v.degree - 1) % v.degree];  // the one clockwise of where we came from bounds the same region
}

void LabelNetwork::thin_chain(HalfEdge start, double min_gap_mm, std::vector<char>& seen,
                              std::vector<char>& keep) const {
  // Short chains keep all their points: a region between two of them needs its shape.
  constexpr double kGapsOfALongChain = 6;
  std::vector<std::uint32_t> chain{from(start)};
  double length = 0;
  for (HalfEdge h = start;; h = next_around_region(h)) {
    seen[h / 2] = 1;
    length += (vertices_[to(h)].point - vertices_[from(h)].point).norm();
    chain.push_back(to(h));
    if (to(h) == chain.front() || vertices_[to(h)].degree > 2) break;
  }
  const double gap = length < kGapsOfALongChain * min_gap_mm ? 0 : min_gap_mm;
  keep[chain.front()] = keep[chain.back()] = 1;
  Eigen::Vector2d last = vertices_[chain.front()].point;
  const Eigen::Vector2d& end = vertices_[chain.back()].point;
  for (const std::uint32_t v : chain) {
    const Eigen::Vector2d& p = vertices_[v].point;
    if ((p - last).norm() < gap || (p - end).norm() < gap) continue;
    keep[v] = 1;
    last = p;
  }
}

std::vector<char> LabelNetwork::kept_vertices(double min_gap_mm) const {
  std::vector<char> seen(segments_.size(), 0), keep(vertices_.size(), 0);
  for (const Vertex& v : vertices_)
    for (std::uint32_t i = 0; v.degree > 2 && i < v.degree; ++i)
      if (!seen[v.out[i] / 2]) thin_chain(v.out[i], min_gap_mm, seen, keep);
  for (std::size_t s = 0; s < segments_.size(); ++s)
    if (!seen[s]) thin_chain(static_cast<HalfEdge>(2 * s), min_gap_mm, seen, keep);
  return keep;
}

PhantomSection LabelNetwork::loops(double min_gap_mm) const {
  const std::vector<char> keep = kept_vertices(min_gap_mm);
  std::vector<char> seen(2 * segments_.size(), 0);
  PhantomSection section;
  for (HalfEdge start = 0; start < seen.size(); ++start) {
    if (seen[start]) continue;
    const std::size_t first = section.points.size();
    for (HalfEdge h = start; !seen[h]; h = next_around_region(h)) {
      seen[h] = 1;
      if (keep[from(h)]) section.points.push_back(vertices_[from(h)].point);
    }
    // Clockwise is the inner border of a region, which is the outer one of what lies within.
    const std::size_t count = section.points.size() - first;
    if (count < 3 || signed_area({&section.points[first], count}) <= 0) {
      section.points.resize(first);
      continue;
    }
    const Label label = left_of(start);
    section.loops.push_back(
        {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count), label, label == kOutside});
  }
  return section;
}

}  // namespace sonoloft::device_sim
