#pragma once
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/slice/result.h"

namespace sonoloft {

/// Collects what a mesh file says, in any order, and checks it in the end.
class MeshBuilder {
 public:
  void set_labels(Label front, Label back) {
    front_ = front;
    back_ = back;
  }

  void add_position(const Eigen::Vector3d& p) { mesh_.positions.push_back(p.cast<float>()); }

  /// Cuts a polygon into a fan. What has fewer than 3 corners, or uses a corner twice in a triangle, has no area.
  void add_polygon(std::span<const std::uint32_t> corners) {
    for (std::size_t k = 2; k < corners.size(); ++k) {
      const std::uint32_t a = corners[0], b = corners[k - 1], c = corners[k];
      if (a == b || b == c || c == a) continue;
      mesh_.triangles.push_back({a, b, c});
      mesh_.label_front.push_back(front_);
      mesh_.label_back.push_back(back_);
    }
  }

  std::uint32_t position_count() const { return static_cast<std::uint32_t>(mesh_.positions.size()); }

  /// Positions that no triangle uses are left out; the others keep their order.
  /// @error non_finite, parse_failed (a corner that is not there, equal or reserved labels)
  Result<IndexedMesh> finish(const std::string& name) && {
    for (const Eigen::Vector3f& p : mesh_.positions)
      if (!p.allFinite()) return fail(ErrorCode::non_finite, name + ": a coordinate is not finite: mend the vertex");
    for (const auto& triangle : mesh_.triangles)
      for (const std::uint32_t corner : triangle)
        if (corner >= mesh_.positions.size())
          return fail(ErrorCode::parse_failed, name + ": a face names vertex " + std::to_string(corner) + " of " +
                                                   std::to_string(mesh_.positions.size()) + ": the file is damaged");
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
      if (mesh_.label_front[t] > kMaxLabel || mesh_.label_back[t] > kMaxLabel ||
          mesh_.label_front[t] == mesh_.label_back[t])
        return fail(ErrorCode::parse_failed, name + ": a face does not lie between two labels: the file is damaged");
    leave_out_unused();
    return std::move(mesh_);
  }

 private:
  void leave_out_unused() {
    std::vector<std::uint32_t> renumbered(mesh_.positions.size(), kUnused);
    for (const auto& triangle : mesh_.triangles)
      for (const std::uint32_t corner : triangle) renumbered[corner] = 0;
    std::uint32_t count = 0;
    for (std::uint32_t v = 0; v < renumbered.size(); ++v)
      if (renumbered[v] != kUnused) mesh_.positions[renumbered[v] = count++] = mesh_.positions[v];
    mesh_.positions.resize(count);
    for (auto& triangle : mesh_.triangles)
      for (std::uint32_t& corner : triangle) corner = renumbered[corner];
  }

  static constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  IndexedMesh mesh_;
  Label front_ = kOutside, back_ = 1;
};

}  // namespace sonoloft
