#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/cells/cell_store.h"

namespace sonoloft {
namespace {

constexpr double kUlp = std::numeric_limits<double>::epsilon();

double face_area(const Polyhedron& shape, const PolyFace& face) {
  const auto at = [&](std::uint32_t i) -> const Eigen::Vector3d& {
    return shape.vertices[shape.loops[face.first + i]].position;
  };
  Eigen::Vector3d twice = Eigen::Vector3d::Zero();
  for (std::uint32_t i = 1; i + 1 < face.count; ++i) twice += (at(i) - at(0)).cross(at(i + 1) - at(0));
  return 0.5 * twice.norm();
}

/// Every wall of a slice has a cell on both sides of every part of it, every wall of the box a cell inside.
class TwoSides {
 public:
  explicit TwoSides(const CellStore& store)
      : store_(store), users_(store.walls.size()), area_mm2_(store.planes.size()) {}

  void add(const Polyhedron& shape) {
    for (const PolyFace& f : shape.faces) {
      ++users_[f.polygon][f.above];
      area_mm2_[f.plane][f.above] += face_area(shape, f);
    }
  }

  [[nodiscard]] std::string validate(double relative) const {
    for (std::size_t w = 0; w < users_.size(); ++w) {
      const auto [below, above] = users_[w];
      if (below + above != store_.walls[w].users) return "wall " + std::to_string(w) + ": wrong count of users";
      if (below > 1 || above > 1) return "wall " + std::to_string(w) + ": two cells on one side";
    }
    const Eigen::Vector3d size = store_.box.sizes();
    const double tolerance_mm2 = relative * size.squaredNorm();
    for (std::size_t p = 0; p < area_mm2_.size(); ++p) {
      const auto [below, above] = area_mm2_[p];
      const double opposite = p < kBoxWalls ? size.prod() / size[static_cast<Eigen::Index>(p / 2)] : below;
      if (std::abs(above - opposite) > tolerance_mm2 || (p < kBoxWalls && below > 0.0))
        return "plane " + std::to_string(p) + ": walls with one side only";
    }
    return {};
  }

 private:
  const CellStore& store_;
  std::vector<std::array<std::uint32_t, 2>> users_;  ///< [#walls] below, above
  std::vector<std::array<double, 2>> area_mm2_;      ///< [#planes] of the faces of cells below, above
};

/// Whether the tree leads to the cell's centre. A cell thinner than the rounding of coordinates has no double inside
/// that could be looked for.
bool found(const CellStore& store, std::size_t cell, double tolerance_mm) {
  const Polyhedron& shape = store.cells[cell].shape;
  const Eigen::Vector3d middle = centre(shape);
  const bool thick = std::all_of(shape.faces.begin(), shape.faces.end(), [&](const PolyFace& f) {
    return std::abs(store.planes[f.plane].distance(middle)) > tolerance_mm;
  });
  return !thick || store.locate(middle) == CellId{static_cast<std::uint32_t>(cell)};
}

}  // namespace

std::string validate(const CellStore& store) {
  const double tolerance_mm = 256.0 * kUlp * store.scale;
  // Coordinates are rounded: in a tiny box far from the origin that is more than 10^-9 of its size.
  const double relative = std::max(1e-9, 4.0 * kUlp * store.scale / store.box.sizes().minCoeff());
  double volume_mm3 = 0.0;
  TwoSides walls(store);
  for (std::size_t c = 0; c < store.cells.size(); ++c) {
    const Polyhedron& shape = store.cells[c].shape;
    if (shape.faces.empty()) continue;
    const std::string where = "cell " + std::to_string(c) + ": ";
    if (std::string wrong = validate(shape, store.planes, tolerance_mm); !wrong.empty()) return where + wrong;
    if (!found(store, c, tolerance_mm)) return where + "the tree does not lead to its centre";
    volume_mm3 += volume(shape);
    walls.add(shape);
  }
  if (std::abs(volume_mm3 - store.box.volume()) > relative * store.box.volume())
    return "volumes do not add up to the box";
  return walls.validate(relative);
}

}  // namespace sonoloft
