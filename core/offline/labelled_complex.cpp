#include "core/offline/labelled_complex.h"

namespace sonoloft {
namespace {

/// Of the cells around a vertex: which share a facet at it, and their labels.
struct CellStar {
  std::vector<Label> label;                      ///< [#cells]
  std::vector<std::array<std::size_t, 3>> next;  ///< [#cells] behind the facets at the vertex
};

CellStar star_of(const LabelledComplex& complex, LabelledComplex::Vertex_handle vertex) {
  std::vector<LabelledComplex::Cell_handle> cells;
  complex.triangulation().incident_cells(vertex, std::back_inserter(cells));
  std::ranges::sort(cells);
  CellStar star;
  for (const auto& cell : cells) {
    star.label.push_back(complex.label(cell));
    auto& next = star.next.emplace_back();
    for (int i = 0, n = 0; i < 4; ++i)
      if (cell->vertex(i) != vertex)
        next[static_cast<std::size_t>(n++)] =
            static_cast<std::size_t>(std::ranges::lower_bound(cells, cell->neighbor(i)) - cells.begin());
  }
  return star;
}

/// Whether the cells with this label (or all others) hang together by facets.
bool in_one_piece(const CellStar& star, Label label, bool others) {
  const auto wanted = [&](std::size_t cell) { return (star.label[cell] == label) != others; };
  std::vector<char> seen(star.label.size(), 0);
  std::vector<std::size_t> open;
  int pieces = 0;
  for (std::size_t start = 0; start < seen.size(); ++start) {
    if (!wanted(start) || seen[start] != 0) continue;
    if (++pieces > 1) return false;
    seen[start] = 1;
    open.push_back(start);
    while (!open.empty()) {
      const std::size_t cell = open.back();
      open.pop_back();
      for (const std::size_t next : star.next[cell])
        if (wanted(next) && seen[next] == 0) {
          seen[next] = 1;
          open.push_back(next);
        }
    }
  }
  return true;
}

}  // namespace

Label LabelledComplex::label(Cell_handle cell) const {
  if (triangulation().is_infinite(cell)) return kOutside;
  const auto p = triangulation().dual(cell);
  return oracle_->label({p.x(), p.y(), p.z()});
}

bool LabelledComplex::small(const Facet& facet) const {
  const auto& [cell, i] = facet;
  const auto centre = cell->get_facet_surface_center(i);
  return CGAL::squared_distance(centre, cell->vertex((i + 1) & 3)->point().point()) < smallest_squared_;
}

LabelledComplex::Face_status LabelledComplex::face_status(const Edge& edge) const {
  if (const Face_status status = Base::face_status(edge); status != SINGULAR) return status;
  std::vector<Label> runs;
  auto cell = triangulation().incident_cells(edge);
  const auto start = cell;
  do {
    const Label here = label(cell);
    if (runs.empty() || runs.back() != here) runs.push_back(here);
  } while (++cell != start);
  if (runs.size() > 1 && runs.front() == runs.back()) runs.pop_back();
  std::ranges::sort(runs);
  if (std::ranges::adjacent_find(runs) == runs.end()) return REGULAR;
  auto facet = triangulation().incident_facets(edge);
  const auto first = facet;
  do
    if (is_in_complex(*facet) && !small(*facet)) return SINGULAR;
  while (++facet != first);
  return REGULAR;
}

LabelledComplex::Face_status LabelledComplex::face_status(Vertex_handle vertex) const {
  const CellStar star = star_of(*this, vertex);
  std::vector<Label> labels = star.label;
  std::ranges::sort(labels);
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  if (labels.size() < 2) return NOT_IN_COMPLEX;
  const bool regular =
      std::ranges::all_of(labels, [&](Label l) { return in_one_piece(star, l, false) && in_one_piece(star, l, true); });
  if (regular) return REGULAR;
  std::vector<Facet> facets;
  triangulation().finite_incident_facets(vertex, std::back_inserter(facets));
  const bool refinable = std::ranges::any_of(facets, [this](const Facet& f) { return is_in_complex(f) && !small(f); });
  return refinable ? SINGULAR : REGULAR;
}

}  // namespace sonoloft
