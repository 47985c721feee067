#include "core/mesh/drawing/edge_quad.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "core/mesh/drawing/complex_cell.h"

namespace sonoloft {
namespace {

using Corner = std::array<std::int32_t, 3>;

std::int64_t cross(const Corner& a, const Corner& b) {
  return std::int64_t{a[0]} * b[1] - std::int64_t{a[1]} * b[0];
}

/// Both triangles of the quad c0 c1 c2 c3 with diagonal c0 c2 stay in the envelope.
bool inside_envelope(const Corner& c0, const Corner& c1, const Corner& c2, const Corner& c3) {
  // Seen along the edge, the diagonal passes the edge on the side of c_j; the triangle with c_k covers the edge.
  std::int64_t turn = cross(c0, c2);
  const bool left = turn >= 0;
  const Corner& a = left ? c0 : c2;
  const Corner& b = left ? c2 : c0;
  const Corner& k = left ? c3 : c1;
  const Corner& j = left ? c1 : c3;
  if (!left) turn = -turn;
  // Barycentric coordinates of the edge in (a, b, k) are cross(b, k), cross(k, a), turn: it is met within its ends.
  const std::int64_t bk = cross(b, k), ka = cross(k, a);
  const std::int64_t height = bk * a[2] + ka * b[2] + turn * k[2];
  if (height <= 0 || height >= (bk + ka + turn) * kStep) return false;
  // The diagonal meets the half plane of c_j at turn / det of the way to c_j, there inside of triangle (edge, c_j).
  const std::int64_t aj = cross(a, j);
  const std::int64_t det = cross(j, b) + aj;
  const std::int64_t at_j = det * a[2] + aj * (b[2] - a[2]);
  return turn < det && turn * j[2] < at_j && at_j < turn * j[2] + (det - turn) * kStep;
}

Eigen::Vector3f vector(const Corner& from, const Corner& to) {
  return {static_cast<float>(to[0] - from[0]), static_cast<float>(to[1] - from[1]),
          static_cast<float>(to[2] - from[2])};
}

/// Squared sine of the smallest angle of a triangle with two sides ab, ac.
float sharpness(const Eigen::Vector3f& ab, const Eigen::Vector3f& ac) {
  const float l0 = ab.squaredNorm(), l1 = ac.squaredNorm(), l2 = (ac - ab).squaredNorm();
  // The smallest angle lies between the two longer sides, whose product times its sine is twice the area.
  return ab.cross(ac).squaredNorm() * std::min({l0, l1, l2}) / (l0 * l1 * l2);
}

/// The four cells around a lattice edge, counter-clockwise.
struct Ring {
  LocalPoint lower;  ///< lower end of the edge
  std::array<LocalPoint, 4> cell;
  std::array<const CellPoint*, 4> vertex;  ///< null where the cell is not simple
  EdgeQuad quad;                           ///< of those that are

  Ring(const NetGrid& nets, const MixedEdge& edge) : lower(local_point(edge.cell)) {
    const std::size_t w = edge.axis, u = (w + 1) % 3, v = (w + 2) % 3;
    for (std::size_t i = 0; i < 4; ++i) {
      const int du = i == 1 || i == 2 ? -1 : 0, dv = i >= 2 ? -1 : 0;
      std::array<int, 3> at = {lower.x, lower.y, lower.z};
      at[u] += du;
      at[v] += dv;
      cell[i] = {at[0], at[1], at[2]};
      vertex[i] = nets.vertex(cell[i]);
      if (const CellPoint* p = vertex[i]) quad[i] = {(*p)[u] + du * kStep, (*p)[v] + dv * kStep, (*p)[w]};
    }
  }
};

}  // namespace

std::optional<int> safe_diagonal(const EdgeQuad& quad) {
  const auto& [c0, c1, c2, c3] = quad;
  const bool safe02 = inside_envelope(c0, c1, c2, c3);
  const bool safe13 = inside_envelope(c1, c2, c3, c0);
  if (!safe02 && !safe13) return std::nullopt;
  if (safe02 != safe13) return safe02 ? 0 : 1;
  const Eigen::Vector3f c01 = vector(c0, c1), c02 = vector(c0, c2), c03 = vector(c0, c3);
  const Eigen::Vector3f c12 = c02 - c01, c13 = c03 - c01;
  const float sharp02 = std::min(sharpness(c01, c02), sharpness(c02, c03));
  const float sharp13 = std::min(sharpness(c12, c13), sharpness(c13, -c01));
  return sharp02 >= sharp13 ? 0 : 1;
}

bool draw_edge(const NetGrid& nets, const MixedEdge& edge, ChunkBuffer& chunk) {
  const Ring ring(nets, edge);
  const auto draw = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {  // counter-clockwise about the edge
    chunk.add_triangle(a, b, c, edge.upper, edge.lower);
  };
  const auto corner = [&](std::size_t i) { return chunk.cell_vertex(ring.cell[i % 4], *ring.vertex[i % 4]); };
  const bool all_simple = std::find(ring.vertex.begin(), ring.vertex.end(), nullptr) == ring.vertex.end();
  if (all_simple) {
    if (const auto diagonal = safe_diagonal(ring.quad)) {
      const auto first = static_cast<std::size_t>(*diagonal);
      const std::uint32_t a = corner(first), b = corner(first + 1), c = corner(first + 2), d = corner(first + 3);
      draw(a, b, c);
      draw(a, c, d);
      return false;
    }
  }
  for (std::size_t i = 0; i < 4; ++i)
    if (ring.vertex[i] && ring.vertex[(i + 1) % 4]) draw(edge_node(edge, chunk), corner(i), corner(i + 1));
  return all_simple;
}

}  // namespace sonoloft
