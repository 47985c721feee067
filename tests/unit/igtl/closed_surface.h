#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace sonoloft::test {

/// Every edge is used once in either direction.
inline bool is_closed(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> used;
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) ++used[{t[k], t[(k + 1) % 3]}];
  for (const auto& [edge, count] : used)
    if (const auto back = used.find({edge.second, edge.first}); count != 1 || back == used.end()) return false;
  return !triangles.empty();
}

/// Positive where the normals point outwards.
inline double volume(const std::vector<std::array<float, 3>>& points,
                     const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  double six = 0;
  for (const auto& t : triangles) {
    std::array<Eigen::Vector3d, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = Eigen::Vector3f(points[t[k]].data()).cast<double>();
    six += p[0].dot(p[1].cross(p[2]));
  }
  return six / 6;
}

}  // namespace sonoloft::test
