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

/// Crossings keep this near to the middle of an edge: in these cells samples say little about where the labels change,
/// while triangles between nodes that go farther are thin and their diagonals not safe without a test.
constexpr std::int32_t kFromMiddle = kStep * 7 / 100;

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

bool is_lattice_edge(CornerSet edge) {
  return std::has_single_bit(first_of(edge) ^ first_of(edge & (edge - 1)));
}

/// Calls body(edge) for the edges of a simplex.
template <class Body>
void for_each_edge(CornerSet simplex, const Body& body) {
  for (CornerSet from = simplex; from != 0; from &= from - 1)
    for (CornerSet to = from & (from - 1); to != 0; to &= to - 1) body(first_alone(from) | first_alone(to));
}

/// The last set of two corners, 0 if there is none.
CornerSet pair_in(std::span<const CornerSet> sets) {
  CornerSet pair = 0;
  for (const CornerSet set : sets)
    if (std::popcount(set) == 2) pair = set;
  return pair;
}

/// Marching tetrahedra in one cell. The surface between two labels in a tetrahedron is one triangle or quad of the
/// nodes of those of its simplices that have both labels and no label twice.
class CellDrawer {
 public:
  CellDrawer(const CellSamples& samples, LocalPoint cell, ChunkBuffer& chunk)
      : cell_(cell), even_(even_points(cell)), chunk_(chunk), samples_(samples) {}

  void draw_tetrahedra() {
    for (const CornerSet tetrahedron : tetrahedra(even_)) draw_tetrahedron(tetrahedron);
  }

  /// The cone from a vertex over the lines that the tetrahedra leave on a face of the cell.
  void draw_cone(std::uint32_t apex, CornerSet face) {
    for (CornerSet odd = face & ~even_; odd != 0; odd &= odd - 1)
      draw_cone_over_triangle(apex, (face & even_) | first_alone(odd));
  }

 private:
  [[nodiscard]] Label label(unsigned corner) const { return samples_.label[samples_.owner[corner]]; }

  /// The corners of a simplex, label by label.
  struct Parts {
    std::size_t count = 0;
    std::array<CornerSet, 4> corners{};
  };
  [[nodiscard]] Parts parts(CornerSet simplex) const {
    Parts result;
    for (CornerSet rest = simplex; rest != 0; ++result.count) {
      result.corners[result.count] = rest & samples_.corners[samples_.owner[first_of(rest)]];
      rest &= ~result.corners[result.count];
    }
    return result;
  }

  /// The node inside a simplex all of whose labels differ.
  std::uint32_t node(CornerSet simplex) {
    const SimplexName name = kSimplexNames[simplex];
    return chunk_.node(corner_of(cell_, name.lowest), name.kind, [&] { return position(simplex); });
  }

  /// On an edge the crossing; in a triangle the mean of those on its lattice edges, or of all if it has none; in a
  /// tetrahedron the mean of the nodes in its faces. With all crossings in the middle no angle is below 30 degrees,
  /// where means of all crossings leave 19.
  [[nodiscard]] BrickPoint position(CornerSet simplex) {
    const int size = std::popcount(simplex);
    if (size == 2) return crossing_on(simplex);
    std::array<BrickPoint, 4> points;
    std::size_t count = 0;
    const bool has_lattice_edge = right_angle(simplex) != 0;
    for (CornerSet rest = simplex; rest != 0; rest &= rest - 1) {
      const CornerSet face = simplex & ~first_alone(rest);
      if (size == 4 || !has_lattice_edge || is_lattice_edge(face)) points[count++] = chunk_.position(node(face));
    }
    return mean(std::span(points).first(count));
  }

  [[nodiscard]] BrickPoint crossing_on(CornerSet edge) const {
    const unsigned lower = first_of(edge), upper = first_of(edge & (edge - 1));
    const std::int32_t t = near_middle(to_fixed(crossing(samples_, lower, upper)));
    BrickPoint at = cell_ + CellPoint{};
    for (unsigned axis = 0; axis < 3; ++axis) {
      const std::int32_t from = lower >> axis & 1 ? kStep : 0, to = upper >> axis & 1 ? kStep : 0;
      at[axis] += from == to ? from : from < to ? t : kStep - t;
    }
    return at;
  }

  void draw_tetrahedron(CornerSet tetrahedron) {
    const Parts of = parts(tetrahedron);
    if (of.count == 2) draw_two_labels(of.corners[0], of.corners[1]);
    if (of.count == 3) draw_three_labels(tetrahedron, pair_in(of.corners));
    if (of.count == 4) draw_four_labels(tetrahedron);
  }

  /// A triangle about the corner that is alone with its label, or a quad.
  void draw_two_labels(CornerSet a, CornerSet b) {
    if (std::popcount(a) > std::popcount(b)) std::swap(a, b);
    const CornerSet b0 = first_alone(b), b1 = first_alone(b & ~b0), b2 = b & ~(b0 | b1);
    if (b2 != 0) return draw_triangle(node(a | b0), node(a | b1), node(a | b2), a | b0);
    const CornerSet a0 = first_alone(a), a1 = a & ~a0;
    draw_quad(sheet({a0 | b0, a0 | b1, a1 | b1, a1 | b0}));
  }

  /// Both triangles with all three labels have a node. The quads beside the line between these are cut along diagonals
  /// from the same end of it: together they are the cone from there, and so do not cross.
  void draw_three_labels(CornerSet tetrahedron, CornerSet twice) {
    const CornerSet a = first_alone(twice), b = twice & ~a;
    const CornerSet others = tetrahedron & ~twice, x = first_alone(others), y = others & ~x;
    const Sheet beside_x = sheet({a | others, b | others, b | x, a | x});
    const Sheet beside_y = sheet({a | others, b | others, b | y, a | y});
    draw_triangle(beside_x.node[0], beside_x.node[1], node(others), others);
    const auto sharp_x = sharpness_of(beside_x), sharp_y = sharpness_of(beside_y);
    const std::size_t first = sharper({std::min(sharp_x[0], sharp_y[0]), std::min(sharp_x[1], sharp_y[1])});
    draw_quad(beside_x, first);
    draw_quad(beside_y, first);
  }

  /// A quad for every edge. The line between its nodes in triangles passes between the edge and the node of the
  /// tetrahedron (docs/pipeline/6-mesh.md), so with either diagonal it stays where no other quad can be.
  void draw_four_labels(CornerSet tetrahedron) {
    for_each_edge(tetrahedron, [&](CornerSet edge) {
      const CornerSet others = tetrahedron & ~edge, other = first_alone(others);
      draw_quad(sheet({edge, edge | other, tetrahedron, edge | (others & ~other)}));
    });
  }

  void draw_cone_over_triangle(std::uint32_t apex, CornerSet triangle) {
    const Parts of = parts(triangle);
    if (of.count == 2) {
      const CornerSet pair = pair_in(of.corners), alone = triangle & ~pair, b0 = first_alone(pair), b1 = pair & ~b0;
      draw_triangle(apex, node(alone | b0), node(alone | b1), alone | b0);
    }
    if (of.count == 3)
      for_each_edge(triangle, [&](CornerSet edge) { draw_triangle(apex, node(triangle), node(edge), edge); });
  }

  /// A quad: the simplices that its corners are the nodes of.
  struct Sheet {
    std::array<CornerSet, 4> simplex;
    std::array<std::uint32_t, 4> node;
  };
  [[nodiscard]] Sheet sheet(const std::array<CornerSet, 4>& simplices) {
    return {simplices, {node(simplices[0]), node(simplices[1]), node(simplices[2]), node(simplices[3])}};
  }
  [[nodiscard]] std::array<float, 2> sharpness_of(const Sheet& sheet) const {
    const auto at = [&](std::size_t i) { return chunk_.position(sheet.node[i]); };
    return sharpness({at(0), at(1), at(2), at(3)});
  }
  void draw_quad(const Sheet& sheet) { draw_quad(sheet, sharper(sharpness_of(sheet))); }
  /// @param first  where the diagonal starts
  void draw_quad(const Sheet& sheet, std::size_t first) {
    for (const auto& [second, third] : {std::pair{first + 1, first + 2}, std::pair{first + 2, (first + 3) % 4}}) {
      const CornerSet own = pair_in(std::array{sheet.simplex[first], sheet.simplex[second], sheet.simplex[third]});
      draw_triangle(sheet.node[first], sheet.node[second], sheet.node[third], own != 0 ? own : pair_in(sheet.simplex));
    }
  }

  /// @param edge  the plane of the triangle cuts it, and so tells the labels of its ends apart
  void draw_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, CornerSet edge) {
    using Vector = Eigen::Matrix<std::int64_t, 3, 1>;
    const auto vector = [](const BrickPoint& p) { return Vector(p[0], p[1], p[2]); };
    const unsigned lower = first_of(edge), upper = first_of(edge & (edge - 1));
    const Vector origin = vector(chunk_.position(a));
    const Vector normal = (vector(chunk_.position(b)) - origin).cross(vector(chunk_.position(c)) - origin);
    const bool lower_ahead = normal.dot(vector(corner_of(cell_, lower) + CellPoint{}) - origin) > 0;
    chunk_.add_triangle(a, b, c, label(lower_ahead ? lower : upper), label(lower_ahead ? upper : lower));
  }

  LocalPoint cell_;
  CornerSet even_;
  ChunkBuffer& chunk_;
  const CellSamples& samples_;
};

}  // namespace

std::uint32_t edge_node(const MixedEdge& edge, ChunkBuffer& chunk) {
  const LocalPoint lower = local_point(edge.cell);
  return chunk.node(lower, kSimplexNames[set_of(0) | set_of(1u << edge.axis)].kind, [&] {
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
