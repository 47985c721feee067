#pragma once
#include <array>
#include <vector>

#include "core/methods/straight_skeleton/space/facet.h"

namespace sonoloft::skeleton {

/// A triangle of a facet; its normal (counter-clockwise) points to `front`.
struct NetTriangle {
  std::array<std::uint32_t, 3> corners;
  Label front, back;
};

/// A facet, and the curves of both its owners on it, cut where they meet.
class FacetNet {
 public:
  struct Line {
    FormPtr form;                   ///< meets the facet's plane in it
    unsigned borders;               ///< 1: the label of the negative owner may change across it; 2: of the positive one
    std::vector<std::uint32_t> at;  ///< points; the first and second are its ends, until it is put in order
  };

  FacetNet(const Space& space, const Facet& facet);

  std::vector<Corner> points;
  std::vector<Line> lines;

  /// Whether there is but one label on it.
  [[nodiscard]] bool is_plain() const;
  /// @pre the points of every line are in order
  [[nodiscard]] std::vector<NetTriangle> triangles() const;

 private:
  std::uint32_t add_point(const Corner& corner);
  void add_chords(const Footing& footing, unsigned borders);
  void add_chord(const Curve& curve, unsigned borders);
  void meet_lines(Line& f, Line& g);
  [[nodiscard]] Label label(const Corner& p, bool positive) const;
  [[nodiscard]] std::vector<Label> labels(const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                          const std::vector<std::pair<std::array<std::uint32_t, 2>, unsigned>>& edges,
                                          bool positive) const;

  const Space& space_;
  const Facet& facet_;
  double doubt_mm_;
};

/// Along an axis, exactly. @return whether p comes before q
[[nodiscard]] bool is_before(const Corner& p, const Corner& q, std::size_t axis, double doubt_mm);
/// An axis along which no two points of the line in which the planes meet are alike.
[[nodiscard]] std::size_t axis_of_line(const Form& f, const Form& g);

}  // namespace sonoloft::skeleton
