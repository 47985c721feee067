#include "core/mesh/drawing/complex_cell.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <span>
#include <utility>

#include "core/mesh/drawing/quad.h"
#include "core/mesh/drawing/simplex.h"
#include "core/mesh/vertices/cell_vertex.h"

namespace sonoloft {
namespace {

/// Crossings keep this near to the middle of an edge between corners, and are here on one from the centre, 0.3 of its
/// length away: in these cells samples say little about where the labels change, while triangles between nodes that go
/// farther are thin and their diagonals not safe without a test. With all crossings in the middle no angle is below 27
/// degrees.
constexpr std::int32_t kFromMiddle = kStep * 10 / 100;
constexpr std::int32_t kBesideCentre = kStep * 35 / 100;  ///< from the sides of the cell

std::int32_t near_middle(std::int32_t crossing) {
  return std::clamp(crossing, kStep / 2 - kFromMiddle, kStep / 2 + kFromMiddle);
}

BrickPoint mean(std::span<const BrickPoint> points) {
  BrickPoint result{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const BrickPoint& p : points) result[axis] += p[axis];
    result[axis] /= static_cast<std::int32_t>(points.size());
  }
  return result;
}

/// Calls body(edge) for the edges of a simplex.
template <class Body>
void for_each_edge(PointSet simplex, const Body& body) {
  for (PointSet from = simplex; from != 0; from = without_first(from))
    for (PointSet to = without_first(from); to != 0; to = without_first(to)) body(first_alone(from) | first_alone(to));
}

/// The last set of two corners, 0 if there is none.
PointSet pair_in(std::span<const PointSet> sets) {
  PointSet pair = 0;
  for (const PointSet set : sets)
    if (std::popcount(set) == 2) pair = set;
  return pair;
}

/// Marching tetrahedra in one cell. The surface between two labels in a tetrahedron is one triangle or quad of the
/// nodes of those of its simplices that have both labels and no label twice.
class CellDrawer {
 public:
  CellDrawer(const CellSamples& samples, LocalPoint cell, ChunkBuffer& chunk)
      : cell_(cell), chunk_(chunk), samples_(samples), of_centre_(strongest(kAllCorners)) {}

  void draw_tetrahedra() {
    for (const PointSet face : kFaceCorners)
      for_triangles(face, [&](PointSet triangle) { draw_tetrahedron(triangle | kCentreAlone); });
  }

  /// The cone from a vertex over the lines that the tetrahedra leave on a face of the cell.
  void draw_cone(std::uint32_t apex, PointSet face) {
    for_triangles(face, [&](PointSet triangle) { draw_cone_over_triangle(apex, triangle); });
  }

 private:
  /// Of the labels of some corners the one with the largest mean share there, as an index; of equals the first.
  [[nodiscard]] std::size_t strongest(PointSet corners) const {
    std::size_t best = 0;
    float most = 0;
    bool found = false;
    for (std::size_t i = 0; i < static_cast<std::size_t>(samples_.label_count); ++i) {
      if ((samples_.corners[i] & corners) == 0) continue;
      float sum = 0;
      for (PointSet rest = corners; rest != 0; rest = without_first(rest)) sum += samples_.share[i][first_of(rest)];
      if (found && !(sum > most)) continue;
      best = i;
      most = sum;
      found = true;
    }
    return best;
  }

  /// Calls body(triangle) for both triangles of a face. It is cut along the diagonal with more corners of the label
  /// that is strongest there: samples decide what touches and what does not. The same in both cells of the face.
  template <class Body>
  void for_triangles(PointSet face, const Body& body) const {
    const PointSet strong = samples_.corners[strongest(face)];
    const PointSet one = first_alone(face) | std::bit_floor(face), other = face & ~one;
    const PointSet diagonal = std::popcount(strong & other) > std::popcount(strong & one) ? other : one;
    for (PointSet rest = face & ~diagonal; rest != 0; rest = without_first(rest)) body(diagonal | first_alone(rest));
  }

  [[nodiscard]] std::size_t owner(unsigned point) const {
    return point == kCentre ? of_centre_ : samples_.owner[point];
  }
  [[nodiscard]] Label label(unsigned point) const { return samples_.label[owner(point)]; }

  /// The points of a simplex, label by label.
  struct Parts {
    std::size_t count = 0;
    std::array<PointSet, 4> points{};
  };
  [[nodiscard]] Parts parts(PointSet simplex) const {
    Parts result;
    for (PointSet rest = simplex; rest != 0; ++result.count) {
      const std::size_t of = owner(first_of(rest));
      const PointSet all = samples_.corners[of] | (of == of_centre_ ? kCentreAlone : 0);
      result.points[result.count] = rest & all;
      rest &= ~all;
    }
    return result;
  }

  /// The node inside a simplex all of whose labels differ.
  std::uint32_t node(PointSet simplex) {
    const SimplexName name = kSimplexNames[simplex];
    return chunk_.node(corner_of(cell_, name.lowest), name.kind, [&] { return position(simplex); });
  }

  /// On an edge the crossing, in others the mean of the nodes in their faces.
  [[nodiscard]] BrickPoint position(PointSet simplex) {
    if (std::popcount(simplex) == 2) return crossing_on(simplex);
    std::array<BrickPoint, 4> nodes;
    std::size_t count = 0;
    for (PointSet rest = simplex; rest != 0; rest = without_first(rest))
      nodes[count++] = chunk_.position(node(simplex & ~first_alone(rest)));
    return mean(std::span(nodes).first(count));
  }

  [[nodiscard]] BrickPoint crossing_on(PointSet edge) const {
    const unsigned lower = first_of(edge), upper = first_of(without_first(edge));
    BrickPoint at = cell_ + CellPoint{};
    if (upper == kCentre) {
      for (unsigned axis = 0; axis < 3; ++axis) at[axis] += lower >> axis & 1 ? kStep - kBesideCentre : kBesideCentre;
      return at;
    }
    const std::int32_t t = near_middle(to_fixed(crossing(samples_, lower, upper)));
    for (unsigned axis = 0; axis < 3; ++axis) {
      const std::int32_t from = lower >> axis & 1 ? kStep : 0, to = upper >> axis & 1 ? kStep : 0;
      at[axis] += from == to ? from : from < to ? t : kStep - t;
    }
    return at;
  }

  void draw_tetrahedron(PointSet tetrahedron) {
    const Parts of = parts(tetrahedron);
    if (of.count == 2) draw_two_labels(of.points[0], of.points[1]);
    if (of.count == 3) draw_three_labels(tetrahedron, pair_in(of.points));
    if (of.count == 4) draw_four_labels(tetrahedron);
  }

  /// A triangle about the corner that is alone with its label, or a quad.
  void draw_two_labels(PointSet a, PointSet b) {
    if (std::popcount(a) > std::popcount(b)) std::swap(a, b);
    const PointSet b0 = first_alone(b), b1 = first_alone(b & ~b0), b2 = b & ~(b0 | b1);
    if (b2 != 0) return draw_triangle(node(a | b0), node(a | b1), node(a | b2), a | b0);
    const PointSet a0 = first_alone(a), a1 = a & ~a0;
    draw_quad({a0 | b0, a0 | b1, a1 | b1, a1 | b0});
  }

  /// The line between the nodes of both triangles with all three labels parts three surfaces.
  void draw_three_labels(PointSet tetrahedron, PointSet twice) {
    const PointSet a = first_alone(twice), b = twice & ~a;
    const PointSet others = tetrahedron & ~twice, x = first_alone(others), y = others & ~x;
    draw_triangle(node(a | others), node(b | others), node(others), others);
    draw_quad({a | others, b | others, b | x, a | x});
    draw_quad({a | others, b | others, b | y, a | y});
  }

  /// A quad for every edge.
  void draw_four_labels(PointSet tetrahedron) {
    for_each_edge(tetrahedron, [&](PointSet edge) {
      const PointSet others = tetrahedron & ~edge, other = first_alone(others);
      draw_quad({edge, edge | other, tetrahedron, edge | (others & ~other)});
    });
  }

  void draw_cone_over_triangle(std::uint32_t apex, PointSet triangle) {
    const Parts of = parts(triangle);
    if (of.count == 2) {
      const PointSet pair = pair_in(of.points), alone = triangle & ~pair, b0 = first_alone(pair), b1 = pair & ~b0;
      draw_triangle(apex, node(alone | b0), node(alone | b1), alone | b0);
    }
    if (of.count == 3)
      for_each_edge(triangle, [&](PointSet edge) { draw_triangle(apex, node(triangle), node(edge), edge); });
  }

  /// Cut along the better diagonal: in a tetrahedron both are safe (docs/pipeline/6-mesh.md).
  /// @param corners  simplices, in whose nodes the corners of the quad are
  void draw_quad(const std::array<PointSet, 4>& corners) {
    std::array<std::uint32_t, 4> nodes;
    Quad quad;
    for (std::size_t i = 0; i < 4; ++i) {
      nodes[i] = node(corners[i]);
      quad[i] = chunk_.position(nodes[i]);
    }
    const std::size_t first = sharper(sharpness(quad));
    for (const auto& [second, third] : {std::pair{first + 1, first + 2}, std::pair{first + 2, (first + 3) % 4}}) {
      const PointSet own = pair_in(std::array{corners[first], corners[second], corners[third]});
      draw_triangle(nodes[first], nodes[second], nodes[third], own != 0 ? own : pair_in(corners));
    }
  }

  /// @param edge  the plane of the triangle cuts it, and so tells the labels of its ends apart
  void draw_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, PointSet edge) {
    using Vector = Eigen::Matrix<std::int64_t, 3, 1>;
    const auto vector = [](const BrickPoint& p) { return Vector(p[0], p[1], p[2]); };
    const unsigned lower = first_of(edge), upper = first_of(without_first(edge));
    const Vector origin = vector(chunk_.position(a));
    const Vector normal = (vector(chunk_.position(b)) - origin).cross(vector(chunk_.position(c)) - origin);
    const bool lower_ahead = normal.dot(vector(corner_of(cell_, lower) + CellPoint{}) - origin) > 0;
    chunk_.add_triangle(a, b, c, label(lower_ahead ? lower : upper), label(lower_ahead ? upper : lower));
  }

  LocalPoint cell_;
  ChunkBuffer& chunk_;
  const CellSamples& samples_;
  std::size_t of_centre_;  ///< label, as an index
};

}  // namespace

std::uint32_t edge_node(const MixedEdge& edge, ChunkBuffer& chunk) {
  const LocalPoint lower = local_point(edge.cell);
  return chunk.node(lower, kSimplexNames[1u | 1u << (1u << edge.axis)].kind, [&] {
    BrickPoint at = lower + CellPoint{};
    at[edge.axis] += near_middle(edge.crossing);
    return at;
  });
}

void draw_complex_cell(const CellSamples& samples, const NetGrid& nets, LocalPoint cell, ChunkBuffer& chunk) {
  CellDrawer drawer(samples, cell, chunk);
  drawer.draw_tetrahedra();
  const unsigned mixed = mixed_faces(samples);
  for (unsigned face = 0; face < 6; ++face) {
    const unsigned axis = face / 2;
    const int direction = face % 2 ? 1 : -1;
    const LocalPoint beside{cell.x + (axis == 0 ? direction : 0), cell.y + (axis == 1 ? direction : 0),
                            cell.z + (axis == 2 ? direction : 0)};
    const CellPoint* vertex = (mixed >> face & 1) != 0 ? nets.vertex(beside) : nullptr;
    if (vertex) drawer.draw_cone(chunk.cell_vertex(ChunkBuffer::place(beside), *vertex), kFaceCorners[face]);
  }
}

}  // namespace sonoloft
