#include "core/mesh/drawing/edge_quad.h"

#include <algorithm>
#include <cstdlib>

#include "core/mesh/drawing/complex_cell.h"

namespace sonoloft {
namespace {

using Corner = std::array<std::int32_t, 3>;

std::int64_t cross(const Corner& a, const Corner& b) {
  return std::int64_t{a[0]} * b[1] - std::int64_t{a[1]} * b[0];
}

/// Both triangles of the quad with the diagonal from corner `first` stay in the envelope.
bool inside_envelope(const EdgeQuad& quad, std::size_t first) {
  // Seen along the edge, the diagonal passes the edge on the side of c_j; the triangle with c_k covers the edge.
  const std::int64_t to_left = cross(quad[first], quad[first + 2]), turn = std::abs(to_left);
  const std::size_t start = first + (to_left >= 0 ? 0 : 2);  // an index, not a branch that no one can foretell
  const Corner &a = quad[start % 4], &j = quad[(start + 1) % 4], &b = quad[(start + 2) % 4], &k = quad[(start + 3) % 4];
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

/// The four cells around a lattice edge, counter-clockwise.
struct Ring {
  std::array<int, 4> place;                ///< ChunkBuffer::place() of the cell
  std::array<const CellPoint*, 4> vertex;  ///< null where the cell is not simple
  EdgeQuad quad;                           ///< of those that are

  Ring(const NetGrid& nets, const MixedEdge& edge) {
    const std::size_t w = edge.axis, u = (w + 1) % 3, v = (w + 2) % 3;
    // To the cells below in u and in v, which may lie in the brick before: steps between nets and within them.
    const Step below_u(edge.cell, u), below_v(edge.cell, v);
    const Step none, both = below_u + below_v;
    const std::array<const Step*, 4> to = {&none, &below_u, &both, &below_v};
    const int own = ChunkBuffer::place(local_point(edge.cell));
    for (std::size_t i = 0; i < 4; ++i) {
      const BrickNet* net = nets.nets[static_cast<std::size_t>(kOwnNet + to[i]->net)];
      place[i] = own + to[i]->place;
      vertex[i] = net ? net->vertex(static_cast<std::size_t>(edge.cell + to[i]->cell)) : nullptr;
      const int du = i == 1 || i == 2 ? -kStep : 0, dv = i >= 2 ? -kStep : 0;
      if (const CellPoint* p = vertex[i]) quad[i] = {(*p)[u] + du, (*p)[v] + dv, (*p)[w]};
    }
  }

 private:
  static constexpr int kOwnNet = NetGrid::index(0, 0, 0);
  struct Step {
    int net = 0, cell = 0, place = 0;

    Step() = default;
    /// To the cell below one.
    Step(int cell_index, std::size_t axis) {
      constexpr std::array<int, 3> kNets = {1, 3, 9};
      const int stride = 1 << (3 * axis);
      const bool first = (cell_index >> (3 * axis) & 7) == 0;
      net = first ? -kNets[axis] : 0;
      cell = first ? stride * (kBrickSize - 1) : -stride;
      place = -ChunkBuffer::kPlaces[axis];
    }
    Step operator+(const Step& other) const {
      Step sum;
      sum.net = net + other.net;
      sum.cell = cell + other.cell;
      sum.place = place + other.place;
      return sum;
    }
  };
};

}  // namespace

std::optional<int> safe_diagonal(const EdgeQuad& quad) {
  const bool safe02 = inside_envelope(quad, 0), safe13 = inside_envelope(quad, 1);
  if (!safe02 && !safe13) return std::nullopt;
  if (safe02 != safe13) return safe02 ? 0 : 1;
  return sharper(sharpness(quad));
}

bool draw_edge(const NetGrid& nets, const MixedEdge& edge, ChunkBuffer& chunk) {
  const Ring ring(nets, edge);
  const auto draw = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {  // counter-clockwise about the edge
    chunk.add_triangle(a, b, c, edge.upper, edge.lower);
  };
  const auto corner = [&](std::size_t i) { return chunk.cell_vertex(ring.place[i % 4], *ring.vertex[i % 4]); };
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
