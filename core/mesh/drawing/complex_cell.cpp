#include "core/mesh/drawing/complex_cell.h"

#include <Eigen/Geometry>

#include "core/mesh/vertices/cell_vertex.h"

namespace sonoloft {
namespace {

/// Corners of a cell, each containing the one before it as a bit set.
struct Simplex {
  int size = 0;
  std::array<unsigned, 4> corner{};

  void add(unsigned c) { corner[static_cast<std::size_t>(size++)] = c; }
  [[nodiscard]] unsigned at(int i) const { return corner[static_cast<std::size_t>(i)]; }
  [[nodiscard]] unsigned set() const {
    unsigned bits = 0;
    for (int i = 0; i < size; ++i) bits |= 1u << at(i);
    return bits;
  }
  [[nodiscard]] bool contains(const Simplex& other) const { return (other.set() & ~set()) == 0; }
  [[nodiscard]] unsigned kind() const { return simplex_kind(at(0) ^ at(1), size > 2 ? at(0) ^ at(2) : 0, size > 3); }
};

class CellDrawer {
 public:
  CellDrawer(const CellSamples& samples, LocalPoint cell, ChunkBuffer& chunk)
      : cell_(cell), chunk_(chunk), samples_(samples) {}

  /// The node inside a simplex all of whose labels differ: the mean of the crossings on its edges. Kept in its open
  /// simplex by rounding too, since coordinates that are equal all over the simplex stay equal.
  std::uint32_t node(const Simplex& simplex) {
    return chunk_.node(corner_of(cell_, simplex.at(0)), simplex.kind(), [&] {
      BrickPoint sum{};
      int crossings = 0;
      for (int j = 1; j < simplex.size; ++j)
        for (int i = 0; i < j; ++i, ++crossings) add_crossing(simplex.at(i), simplex.at(j), sum);
      return BrickPoint{cell_.x * kStep + sum[0] / crossings, cell_.y * kStep + sum[1] / crossings,
                        cell_.z * kStep + sum[2] / crossings};
    });
  }

  void draw_tetrahedra() {
    for (unsigned first = 1; first < 8; first <<= 1)
      for (unsigned second = 1; second < 8; second <<= 1)
        if (second != first) draw_tetrahedron({4, {0, first, first | second, 7}});
  }

  [[nodiscard]] bool is_mixed(unsigned face) const { return (mixed_faces(samples_) >> face & 1) != 0; }

  /// The cone from a vertex over the lines that the tetrahedra leave on a face of the cell.
  void draw_cone(std::uint32_t apex, unsigned axis, bool upper) {
    const unsigned u = 1u << (axis + 1) % 3, v = 1u << (axis + 2) % 3, base = upper ? 1u << axis : 0;
    draw_cone(apex, {3, {base, base | u, base | u | v}});
    draw_cone(apex, {3, {base, base | v, base | u | v}});
  }

 private:
  [[nodiscard]] Label label(unsigned corner) const { return samples_.label[samples_.owner[corner]]; }

  /// One corner of each label: the simplex in whose node all the labels meet.
  [[nodiscard]] Simplex one_of_each_label(const Simplex& simplex) const {
    Simplex result;
    for (int i = 0; i < simplex.size; ++i) {
      bool seen = false;
      for (int j = 0; j < result.size; ++j) seen |= label(simplex.at(i)) == label(result.at(j));
      if (!seen) result.add(simplex.at(i));
    }
    return result;
  }

  void add_crossing(unsigned lower, unsigned upper, BrickPoint& sum) const {
    const std::int32_t t = to_fixed(crossing(samples_, lower, upper));
    for (unsigned axis = 0; axis < 3; ++axis)
      sum[axis] += (lower >> axis & 1 ? kStep : 0) + ((lower ^ upper) >> axis & 1 ? t : 0);
  }

  /// The surfaces inside a simplex are the cone from the node where all its labels meet over those on the faces that
  /// do not touch that node. So are the lines on a triangle.
  void draw_tetrahedron(const Simplex& tetrahedron) {
    const Simplex centre = one_of_each_label(tetrahedron);
    if (centre.size == 1) return;
    for (int left_out = 0; left_out < 4; ++left_out) {
      Simplex face;
      for (int i = 0; i < 4; ++i)
        if (i != left_out) face.add(tetrahedron.at(i));
      if (!face.contains(centre)) draw_cone(node(centre), face);
    }
  }

  void draw_cone(std::uint32_t apex, const Simplex& triangle) {
    const Simplex centre = one_of_each_label(triangle);
    if (centre.size == 1) return;
    for (int j = 1; j < 3; ++j) {
      for (int i = 0; i < j; ++i) {
        const Simplex edge{2, {triangle.at(i), triangle.at(j)}};
        if (label(edge.at(0)) == label(edge.at(1)) || edge.contains(centre)) continue;
        draw_triangle(apex, node(centre), node(edge), edge);
      }
    }
  }

  /// The plane of every triangle cuts the edge that its last node is on, and so tells the labels of its ends apart.
  void draw_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, const Simplex& edge) {
    using Vector = Eigen::Matrix<std::int64_t, 3, 1>;
    const auto vector = [](const BrickPoint& p) { return Vector(p[0], p[1], p[2]); };
    const LocalPoint lower = corner_of(cell_, edge.at(0));
    const Vector origin = vector(chunk_.position(a));
    const Vector normal = (vector(chunk_.position(b)) - origin).cross(vector(chunk_.position(c)) - origin);
    const bool lower_ahead = normal.dot(vector(lower + CellPoint{0, 0, 0}) - origin) > 0;
    const Label l = label(edge.at(0)), u = label(edge.at(1));
    chunk_.add_triangle(a, b, c, lower_ahead ? l : u, lower_ahead ? u : l);
  }

  LocalPoint cell_;
  ChunkBuffer& chunk_;
  const CellSamples& samples_;
};

}  // namespace

std::uint32_t edge_node(const MixedEdge& edge, ChunkBuffer& chunk) {
  const LocalPoint lower = local_point(edge.cell);
  return chunk.node(lower, simplex_kind(1u << edge.axis, 0, false), [&] {
    CellPoint on{};
    on[edge.axis] = edge.crossing;
    return lower + on;
  });
}

void draw_complex_cell(const CellSamples& samples, const NetGrid& nets, LocalPoint cell, ChunkBuffer& chunk) {
  CellDrawer drawer(samples, cell, chunk);
  drawer.draw_tetrahedra();
  for (unsigned face = 0; face < 6; ++face) {
    const unsigned axis = face / 2;
    const int direction = face % 2 ? 1 : -1;
    const LocalPoint beside{cell.x + (axis == 0 ? direction : 0), cell.y + (axis == 1 ? direction : 0),
                            cell.z + (axis == 2 ? direction : 0)};
    const CellPoint* vertex = drawer.is_mixed(face) ? nets.vertex(beside) : nullptr;
    if (vertex) drawer.draw_cone(chunk.cell_vertex(ChunkBuffer::place(beside), *vertex), axis, direction > 0);
  }
}

}  // namespace sonoloft
