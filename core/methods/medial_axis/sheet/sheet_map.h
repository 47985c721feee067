#pragma once
#include "core/methods/medial_axis/axis/cell_axis.h"

namespace sonoloft::medial {

/// The image of one face in that of another, by way of the sheet between them.
struct SheetMap {
  SheetMap(const PlaneSet& planes, const Facing& from, const Facing& to) {
    const Number parting =
        planes.normals(from.plane, from.plane) - from.side * to.side * planes.normals(from.plane, to.plane);
    const auto mapped = [&](double x, double y) {
      const Point p(x, y);
      const Number height = to.side * planes.trace(from.plane, to.plane).at(p) / parting;
      Triple at = planes.point(from.plane, p);
      for (std::size_t i = 0; i < 3; ++i) at[i] += from.side * height * planes[from.plane].normal[i];
      return planes.foot(to.plane, at);
    };
    origin = mapped(0, 0);
    const Point along_x = mapped(1, 0), along_y = mapped(0, 1);
    xx = along_x.x() - origin.x(), xy = along_x.y() - origin.y();
    yx = along_y.x() - origin.x(), yy = along_y.y() - origin.y();
  }
  [[nodiscard]] Point operator()(const Point& p) const {
    return {origin.x() + xx * p.x() + yx * p.y(), origin.y() + xy * p.x() + yy * p.y()};
  }
  Point origin;
  Number xx, xy, yx, yy;
};

}  // namespace sonoloft::medial
