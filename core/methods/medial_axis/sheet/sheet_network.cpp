#include "core/methods/medial_axis/sheet/sheet_network.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <optional>

#include "core/methods/medial_axis/sheet/sheet_map.h"

namespace sonoloft::medial {
namespace {

struct Cut {
  Number along;
  std::uint32_t at;  ///< in SheetNetwork::points
};

struct Piece {
  std::uint32_t a, b;  ///< in SheetNetwork::points
  CurveStretch of;
  std::uint32_t line;
  Eigen::AlignedBox2d box;
  std::vector<Cut> cuts;
};

class NetworkBuilder {
 public:
  NetworkBuilder(const CurveNetwork& network, const CellAxis& axis, const Sheet& sheet, CellCurves& curves,
                 SheetNetwork& out)
      : network_(network), axis_(axis), sheet_(sheet), curves_(curves), out_(out) {}

  void build(std::span<const CurveStretch> stretches) {
    add_outline();
    for (const CurveStretch& s : stretches) add_piece(s);
    unify_points();
    for (Piece& f : pieces_[0])
      for (Piece& g : pieces_[1])
        if (f.box.intersects(g.box)) meet(f, g);
    for (std::size_t side = 0; side < 2; ++side)
      for (Piece& piece : pieces_[side]) add_edges(piece, side);
    for (const auto& [ends, edge] : edges_) out_.edges.push_back(edge);
  }

 private:
  const CurveVertex& vertex(std::uint32_t at) const { return curves_.vertices[out_.vertices[at]]; }

  std::uint32_t add_point(std::uint32_t id, const Point& at) {
    const auto [place, is_new] = places_.try_emplace(id, static_cast<std::uint32_t>(out_.points.size()));
    if (is_new) {
      out_.vertices.push_back(id);
      out_.points.push_back({at, {}});
    }
    return place->second;
  }

  void add_outline() {
    std::vector<std::uint32_t> loop;
    const auto count = static_cast<std::uint32_t>(sheet_.outline.size());
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::size_t first = loop.size();
      const std::uint32_t from = sheet_.outline[i];
      loop.push_back(from);
      for (const Waypoint& w : curves_.on_ridges[sheet_.sides[i]]) loop.push_back(w.vertex);
      if (axis_.ridges[sheet_.sides[i]].p != from)
        std::reverse(loop.begin() + static_cast<std::ptrdiff_t>(first) + 1, loop.end());
      for (std::size_t k = first; k < loop.size(); ++k) put_on(loop[k], i);
      put_on(sheet_.outline[(i + 1) % count], i);
    }
    for (std::size_t i = 0; i < loop.size(); ++i)
      edge_between(places_.at(loop[i]), places_.at(loop[(i + 1) % loop.size()]));
    lines_ = count;
  }
  void put_on(std::uint32_t id, std::uint32_t line) {
    const std::uint32_t at = places_.contains(id)
                                 ? places_.at(id)
                                 : add_point(id, foot(network_, axis_, id, curves_.vertices[id], sheet_.f));
    out_.points[at].lines.push_back(line);
  }

  void add_piece(const CurveStretch& of) {
    const Curve& curve = curves_.curves[of.curve];
    const std::size_t side = curve.face == sheet_.f ? 0 : 1;
    Piece piece{point_of(curve.roof[of.first].vertex, curve.face),
                point_of(curve.roof[of.first + 1].vertex, curve.face),
                of,
                lines_++,
                {},
                {}};
    for (const std::uint32_t end : {piece.a, piece.b}) {
      out_.points[end].lines.push_back(piece.line);
      piece.box.extend(rounded(out_.points[end].at));
    }
    const Eigen::Vector2d margin = Eigen::Vector2d::Constant(network_.planes.doubt_mm());
    piece.box.min() -= margin;
    piece.box.max() += margin;
    pieces_[side].push_back(std::move(piece));
  }
  std::uint32_t point_of(std::uint32_t id, std::uint32_t face) {
    const auto found = places_.find(id);
    if (found != places_.end()) return found->second;
    const Point at = foot(network_, axis_, id, curves_.vertices[id], face);
    return add_point(id, face == sheet_.f ? at : from_g()(at));
  }
  const SheetMap& from_g() {
    if (!map_) map_.emplace(network_.planes, axis_.faces[sheet_.g], axis_.faces[sheet_.f]);
    return *map_;
  }

  /// A point of f and one of g may be at one place: the later one becomes the earlier one.
  void unify_points();
  void meet(Piece& f, Piece& g);
  void touch(std::uint32_t at, Piece& piece);
  void add_edges(Piece& piece, std::size_t side);

  SheetEdge& edge_between(std::uint32_t a, std::uint32_t b) {
    const std::pair<std::uint32_t, std::uint32_t> ends = std::minmax(a, b);
    return edges_.try_emplace(ends, SheetEdge{{ends.first, ends.second}}).first->second;
  }

  const CurveNetwork& network_;
  const CellAxis& axis_;
  const Sheet& sheet_;
  CellCurves& curves_;
  SheetNetwork& out_;
  std::uint32_t lines_ = 0;
  std::map<std::uint32_t, std::uint32_t> places_;  ///< [vertex] in SheetNetwork::points
  std::array<std::vector<Piece>, 2> pieces_;       ///< of f, of g
  std::optional<SheetMap> map_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, SheetEdge> edges_;
};

void NetworkBuilder::unify_points() {
  std::vector<std::pair<double, std::uint32_t>> inner;  // ascending: what is at one place lies near in it
  for (std::uint32_t i = 0; i < out_.points.size(); ++i)
    if (out_.vertices[i] >= axis_.vertices.size() && vertex(i).ridge == kNoPoint)
      inner.emplace_back(rounded(out_.points[i].at.x()), i);
  std::ranges::sort(inner);
  std::vector<std::uint32_t> same(out_.points.size());
  for (std::uint32_t i = 0; i < same.size(); ++i) same[i] = i;
  bool any = false;
  for (std::size_t i = 0; i < inner.size(); ++i)
    for (std::size_t k = i + 1; k < inner.size() && inner[k].first - inner[i].first < network_.planes.doubt_mm(); ++k) {
      const auto [first, second] = std::minmax(inner[i].second, inner[k].second);
      if (out_.points[first].at != out_.points[second].at) continue;
      same[second] = first;
      curves_.vertices[out_.vertices[second]].same = out_.vertices[first];
      for (const std::uint32_t line : out_.points[second].lines) out_.points[first].lines.push_back(line);
      any = true;
    }
  if (!any) return;
  for (std::vector<Piece>& pieces : pieces_)
    for (Piece& piece : pieces) piece.a = same[piece.a], piece.b = same[piece.b];
}

/// A point that lies on the line of a piece cuts it if it lies within.
void NetworkBuilder::touch(std::uint32_t at, Piece& piece) {
  if (at == piece.a || at == piece.b) return;
  const Number t = place_between(out_.points[piece.a].at, out_.points[piece.b].at, out_.points[at].at);
  if (t <= 0 || t >= 1) return;
  piece.cuts.push_back({t, at});
  out_.points[at].lines.push_back(piece.line);
}

void NetworkBuilder::meet(Piece& f, Piece& g) {
  const auto turn_from = [&](const Piece& piece, std::uint32_t c) {
    return turn_at(out_.points[piece.a], out_.points[piece.b], out_.points[c]);
  };
  const int ga = turn_from(f, g.a), gb = turn_from(f, g.b);
  if (ga * gb > 0) return;
  const int fa = turn_from(g, f.a), fb = turn_from(g, f.b);
  if (fa * fb > 0) return;
  if (ga == 0) touch(g.a, f);
  if (gb == 0) touch(g.b, f);
  if (fa == 0) touch(f.a, g);
  if (fb == 0) touch(f.b, g);
  if (ga * gb == 0 || fa * fb == 0) return;
  const Point a = out_.points[f.a].at, b = out_.points[f.b].at, c = out_.points[g.a].at, d = out_.points[g.b].at;
  const Number s = cross(a, c, c, d) / cross(a, b, c, d), t = cross(c, a, a, b) / cross(c, d, a, b);
  const Point at = between(a, b, s);
  const auto id = static_cast<std::uint32_t>(curves_.vertices.size());
  curves_.vertices.push_back({.position = above(network_.planes, axis_, sheet_, rounded(at))});
  const std::uint32_t here = add_point(id, at);
  out_.points[here].lines = {f.line, g.line};
  f.cuts.push_back({s, here});
  g.cuts.push_back({t, here});
}

void NetworkBuilder::add_edges(Piece& piece, std::size_t side) {
  std::ranges::sort(piece.cuts, [](const Cut& a, const Cut& b) { return a.along < b.along; });
  const auto is_same = [](const Cut& a, const Cut& b) { return a.at == b.at; };
  piece.cuts.erase(std::unique(piece.cuts.begin(), piece.cuts.end(), is_same), piece.cuts.end());
  Curve& curve = curves_.curves[piece.of.curve];
  const NetworkEdge& of = network_.edges[curve.edge];
  const bool flipped = side == 1 && sheet_.flipped;
  const auto add = [&](std::uint32_t a, std::uint32_t b) {
    SheetEdge& edge = edge_between(a, b);
    const bool forwards = (edge.ends[0] == a) != flipped;
    edge.left[side] = forwards ? of.left : of.right;
    edge.right[side] = forwards ? of.right : of.left;
  };
  const Number from = curve.roof[piece.of.first].along, to = curve.roof[piece.of.first + 1].along;
  std::uint32_t last = piece.a;
  for (const Cut& cut : piece.cuts) {
    curve.cuts.push_back({from + cut.along * (to - from), out_.vertices[cut.at]});
    add(last, cut.at);
    last = cut.at;
  }
  add(last, piece.b);
}

}  // namespace

SheetNetwork::SheetNetwork(const CurveNetwork& network, const CellAxis& axis, std::uint32_t sheet,
                           std::span<const CurveStretch> stretches, CellCurves& curves) {
  NetworkBuilder(network, axis, axis.sheets[sheet], curves, *this).build(stretches);
}

}  // namespace sonoloft::medial
