#pragma once
#include <deque>
#include <vector>

#include "core/methods/straight_skeleton/patch/front.h"

namespace sonoloft::skeleton {

/// On whose account a part of space belongs to a front.
struct Owner {
  std::uint32_t front;
  const FrontCell* cell;

  [[nodiscard]] const Form& distance() const { return *cell->distance; }
};

/// A convex polygon along which labels may differ: half-way between two fronts, between two footings of one, or over a
/// curve. The first owner is where its plane is negative.
struct Facet {
  Polygon polygon;
  Owner negative, positive;
  const Curve* curve = nullptr;  ///< over which it lies, or null
  std::vector<FormPtr> off{};    ///< none negative on the facet; where all are positive there is no patch
};

struct Space {
  std::deque<Front> fronts;  ///< the last six are the walls of the box
  ExactBox box;
};

/// What is left of a facet where no third front is nearer.
void keep_nearest(const Space& space, Facet facet, std::vector<Facet>& out);

/// All facets between two fronts, of which the cell belongs to the first one.
[[nodiscard]] std::vector<Facet> sheets(const Space& space, const Owner& of);
/// All facets within a front: over the curves of the cell's footing, and between
/// that and later ones.
[[nodiscard]] std::vector<Facet> uprights(const Space& space, const Owner& of);

}  // namespace sonoloft::skeleton
