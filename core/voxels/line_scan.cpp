#include "core/voxels/line_scan.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

namespace sonoloft {
namespace {

std::pair<std::size_t, std::size_t> rows_of(const IndexedMesh& mesh, std::size_t triangle, const Ticks& rows) {
  const auto& t = mesh.triangles[triangle];
  const auto [low, high] = std::minmax({mesh.positions[t[0]].z(), mesh.positions[t[1]].z(), mesh.positions[t[2]].z()});
  return {rows.first_not_below(low), rows.first_not_below(high)};
}

/// Where the edge meets the plane of constant z, as (x, y). The end points are put in one order first: both triangles
/// of an edge get the same bits, so no line slips through between them or counts twice.
Eigen::Vector2d edge_at(const Eigen::Vector3f& p, const Eigen::Vector3f& q, double z) {
  const bool in_order = std::tuple(p.z(), p.y(), p.x()) < std::tuple(q.z(), q.y(), q.x());
  const Eigen::Vector3d a = (in_order ? p : q).cast<double>();
  const Eigen::Vector3d b = (in_order ? q : p).cast<double>();
  const double t = (z - a.z()) / (b.z() - a.z());
  return a.head<2>() + t * (b.head<2>() - a.head<2>());
}

}  // namespace

std::size_t Ticks::first_not_below(double value) const {
  const double guess = std::clamp(std::ceil((value - start) / step), 0.0, static_cast<double>(count));
  auto index = static_cast<std::size_t>(guess);
  while (index > 0 && at(index - 1) >= value) --index;
  while (index < count && at(index) < value) ++index;
  return index;
}

Result<Eigen::AlignedBox3d> used_box(const IndexedMesh& mesh, const char* what) {
  if (mesh.triangles.empty())
    return fail(ErrorCode::empty_input, std::string(what) + " has no triangle: there is nothing in it to use");
  Eigen::AlignedBox3d box;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      assert(v < mesh.positions.size());
      if (!mesh.positions[v].allFinite()) {
        return fail(ErrorCode::non_finite, std::string(what) + " has a vertex that is not finite (" +
                                               std::to_string(v) + "): repair the mesh");
      }
      box.extend(mesh.positions[v].cast<double>());
    }
  }
  return box;
}

LineScan::LineScan(const IndexedMesh& mesh, const Ticks& y, const Ticks& z)
    : mesh_(mesh), y_(y), z_(z), first_(z.count + 1, 0) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [begin, end] = rows_of(mesh, t, z);
    for (std::size_t k = begin; k < end; ++k) ++first_[k + 1];
  }
  for (std::size_t k = 0; k < z.count; ++k) first_[k + 1] += first_[k];
  triangle_.resize(first_.back());
  auto next = first_;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [begin, end] = rows_of(mesh, t, z);
    for (std::size_t k = begin; k < end; ++k) triangle_[next[k]++] = static_cast<std::uint32_t>(t);
  }
}

void LineScan::crossings(std::size_t row, const Visit& visit) const {
  for (std::size_t i = first_[row]; i < first_[row + 1]; ++i) cross(triangle_[i], z_.at(row), visit);
}

void LineScan::cross(std::size_t triangle, double z, const Visit& visit) const {
  std::array<Eigen::Vector2d, 2> ends;
  std::size_t found = 0;
  const auto& t = mesh_.triangles[triangle];
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3f &p = mesh_.positions[t[i]], &q = mesh_.positions[t[(i + 1) % 3]];
    if ((p.z() <= z) != (q.z() <= z)) ends[found++] = edge_at(p, q, z);
  }
  if (ends[1].y() < ends[0].y()) std::swap(ends[0], ends[1]);
  const std::size_t last = y_.first_not_below(ends[1].y());
  for (std::size_t j = y_.first_not_below(ends[0].y()); j < last; ++j) {
    const double share = (y_.at(j) - ends[0].y()) / (ends[1].y() - ends[0].y());
    visit(static_cast<std::uint32_t>(j), ends[0].x() + share * (ends[1].x() - ends[0].x()), triangle);
  }
}

}  // namespace sonoloft
