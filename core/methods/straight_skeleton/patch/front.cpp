#include "core/methods/straight_skeleton/patch/front.h"

#include <algorithm>
#include <span>

namespace sonoloft::skeleton {
namespace {

/// How much slower than a patch's own front the one from its rim is, and how much it leans back. Without, a rim that
/// lies on another patch, or two rims in one plane, send out fronts that are one and the same, and rounding would say
/// whose a point is: so it belongs to the patch, and to the nearer rim.
const Exact kLean(0x1p-20);
/// Corners that turn by less than this tangent have no part of their own: they cannot be in doubt.
constexpr double kSharp = 0.125;
/// Of one plane: the time goes with the square of either.
constexpr std::size_t kMaxPieces = 100, kMaxCells = 10'000;

FormPtr zero() {
  static const FormPtr form = std::make_shared<const Form>();
  return form;
}

/// Fills what lies over one convex piece: distances from it, and their labels.
class PieceFootings {
 public:
  PieceFootings(const PatchMap& map, const FormPtr& plane, const ExactBox& universe) : map_(map), universe_(universe) {
    all_ = Polygon::across(universe, plane);
    for (const PatchMap::Edge& edge : map.edges) {
      if (edge.left == kUnknown || edge.right == kUnknown) continue;
      const Spot &a = map.spots[edge.a], &b = map.spots[edge.b];
      curves_.push_back({edge.line, {map.image.along(a, b, a), map.image.along(b, a, b)}, edge.left, edge.right});
    }
  }

  std::vector<Footing> of(const ConvexPieces& all, const std::vector<PieceSide>& piece) {
    parts_.clear();
    for (std::size_t i = 0; i < piece.size(); ++i)
      if (piece[i].line) add_side(all, piece, i);
    std::vector<Footing> footings;
    Footing within{all_, zero(), &map_};
    for (const Footing& part : parts_) within.outline.cut(negative(*part.beyond), universe_.doubt_mm);
    add_curves(within);
    footings.push_back(std::move(within));
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      Footing part = parts_[i];
      part.outline = all_;
      part.outline.cut(part.beyond, universe_.doubt_mm);
      for (std::size_t k = 0; k < parts_.size() && !part.outline.empty(); ++k)
        if (k != i) part.outline.cut(difference(*part.beyond, *parts_[k].beyond), universe_.doubt_mm);
      if (!part.outline.empty()) footings.push_back(std::move(part));
    }
    return footings;
  }

 private:
  static bool is_sharp(const PieceSide& side, const PieceSide& next) {
    if (!side.line || !next.line) return false;
    const Eigen::Vector2d d = side.b.rough - side.a.rough, e = next.b.rough - next.a.rough;
    return d.x() * e.y() - d.y() * e.x() > kSharp * d.dot(e);
  }

  void add_side(const ConvexPieces& all, const std::vector<PieceSide>& piece, std::size_t i) {
    const PieceSide &side = piece[i], &last = piece[(i + piece.size() - 1) % piece.size()],
                    &next = piece[(i + 1) % piece.size()];
    const RimLine& line = all.lines[*side.line];
    const Spot &from = side.sign > 0 ? line.a : line.b, &to = side.sign > 0 ? line.b : line.a;
    const FormPtr left = map_.image.line(line.a, line.b);
    const Exact outwards(-side.sign);
    Footing part;
    part.beyond = sum(Form(), outwards + outwards * kLean, *left);
    part.run = map_.labels_along(side.a, side.b);
    part.rim = {map_.image.place(side.a).rough, map_.image.place(side.b).rough};
    for (std::size_t c = 0; c < part.run.changes.size(); ++c)
      part.curves.push_back(
          {map_.image.along(from, to, part.run.changes[c]), {}, part.run.labels[c + 1], part.run.labels[c]});
    if (is_sharp(last, side)) add_corner(part, map_.image.along(to, from, side.a), part.run.labels.front());
    if (is_sharp(side, next)) add_corner(part, map_.image.along(from, to, side.b), part.run.labels.back());
    parts_.push_back(std::move(part));
  }
  void add_corner(const Footing& side, const FormPtr& beyond, Label label) {
    Footing corner;
    corner.beyond = sum(*side.beyond, kLean, *beyond);
    corner.run.labels = {label};
    corner.rim = side.rim;
    parts_.push_back(std::move(corner));
  }

  void add_curves(Footing& within) const {
    for (const Curve& curve : curves_) {
      RoughPolygon near(within.outline, universe_.doubt_mm);
      if (near.cut(curve.ends[0]->rough) && near.cut(curve.ends[1]->rough) && near.cut(curve.line->rough) &&
          near.cut(-curve.line->rough))
        within.curves.push_back(curve);
    }
  }

  const PatchMap& map_;
  const ExactBox& universe_;
  Polygon all_;
  std::vector<Curve> curves_;
  std::vector<Footing> parts_;  ///< of the piece at hand, without outlines
};

/// What two outlines share.
Polygon common(Polygon part, const Polygon& other, double doubt_mm) {
  for (const FormPtr& side : other.sides)
    if (!part.empty()) part.cut(side, doubt_mm);
  return part;
}

/// Takes a convex part away from footings, in few cuts.
void take_away(std::vector<Footing>& footings, const Polygon& lost, double doubt_mm) {
  std::vector<Footing> left;
  for (Footing& footing : footings) {
    if (common(footing.outline, lost, doubt_mm).empty()) {
      left.push_back(std::move(footing));
      continue;
    }
    for (const FormPtr& side : lost.sides) {
      Footing beyond = footing;
      if (beyond.outline.cut(negative(*side), doubt_mm) == Cut::some) left.push_back(std::move(beyond));
      footing.outline.cut(side, doubt_mm);
    }
  }
  footings = std::move(left);
}

/// What is left of a footing where others are nearer. @param or_alike  or as near
void keep_where_nearest(const Footing& of, std::span<const Footing> others, bool or_alike, double doubt_mm,
                        std::vector<Footing>& out) {
  std::vector<Footing> left{of};
  for (const Footing& other : others) {
    const FormPtr by = difference(*of.beyond, *other.beyond);
    if (by->is_zero() && !or_alike) continue;
    Polygon lost = common(of.outline, other.outline, doubt_mm);
    if (!lost.empty() && !by->is_zero()) lost.cut(by, doubt_mm);
    if (!lost.empty()) take_away(left, lost, doubt_mm);
  }
  std::ranges::move(left, std::back_inserter(out));
}

/// Of both pieces, each where it is nearer; where they are alike, of the first one.
std::vector<Footing> joined(std::span<const Footing> first, std::span<const Footing> second, double doubt_mm) {
  std::vector<Footing> out;
  for (const Footing& f : first) keep_where_nearest(f, second, false, doubt_mm, out);
  for (const Footing& g : second) keep_where_nearest(g, first, true, doubt_mm, out);
  return out;
}

/// Whether a rim's distance is positive on no piece of the patches, not on its own one alone.
bool is_off_all(const Front& front, const Form& beyond, double doubt_mm) {
  return std::ranges::all_of(front.footings, [&](const Footing& f) {
    return f.map == nullptr ||
           std::ranges::all_of(f.outline.corners, [&](const Corner& c) { return side_of(beyond, c, doubt_mm) <= 0; });
  });
}

void find_cells(Front& front, const ExactBox& universe) {
  const FormPtr height = front.maps.front().image.height, depth = negative(*height);
  for (std::uint32_t f = 0; f < front.footings.size(); ++f) {
    const Footing& footing = front.footings[f];
    std::vector<FormPtr> sides;
    for (const FormPtr& side : footing.outline.sides)
      if (std::ranges::count(universe.walls, side) == 0) sides.push_back(side);
    for (const FormPtr& above : {height, depth}) {
      const FormPtr leaning = sum(*footing.beyond, kLean, *above), over = difference(*above, *leaning);
      const bool within = footing.beyond->is_zero();
      FrontCell up{f, above, {within ? above : over}, {}};
      up.facets.insert(up.facets.end(), sides.begin(), sides.end());
      front.cells.push_back(std::move(up));
      if (within) continue;
      FrontCell sideways{f, leaning, {above, negative(*over)}, {}};
      sideways.facets.insert(sideways.facets.end(), sides.begin(), sides.end());
      front.cells.push_back(std::move(sideways));
    }
  }
  for (FrontCell& cell : front.cells) {
    cell.off = {cell.distance};
    if (!is_off_all(front, *front.footings[cell.footing].beyond, universe.doubt_mm))
      cell.off.insert(cell.off.end(), cell.facets.begin(), cell.facets.end());
  }
}

}  // namespace

Label Footing::label_at(const Corner& p, const Eigen::Vector3d& towards, double doubt_mm) const {
  if (map != nullptr) return map->label_at(p, towards);
  std::size_t at = 0;
  for (const Curve& curve : curves) {  // one for each change of the run
    int side = side_of(*curve.line, p, doubt_mm);
    if (side == 0) side = curve.line->rough.head<3>().dot(towards) > 0 ? 1 : -1;
    at += side > 0 ? 1 : 0;
  }
  return run.labels[at];
}

bool find_footings(Front& front, const ExactBox& universe, double reach_mm) {
  const FormPtr plane = front.maps.front().image.height;
  for (const PatchMap& map : front.maps) {
    const ConvexPieces all = convex_pieces(map, reach_mm);
    if (all.pieces.size() > kMaxPieces) return false;
    PieceFootings footings(map, plane, universe);
    for (const std::vector<PieceSide>& piece : all.pieces) {
      std::vector<Footing> of_piece = footings.of(all, piece);
      front.footings =
          front.footings.empty() ? std::move(of_piece) : joined(std::move(front.footings), of_piece, universe.doubt_mm);
    }
  }
  find_cells(front, universe);
  return front.cells.size() <= kMaxCells;
}

Front front_of_wall(const FormPtr& wall) {
  Front front;
  front.footings.push_back({.outline = {}, .beyond = zero()});
  front.footings.back().run.labels = {kOutside};
  front.cells.push_back({0, wall, {}, {wall}});
  return front;
}

}  // namespace sonoloft::skeleton
