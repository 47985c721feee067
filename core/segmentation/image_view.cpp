#include "core/segmentation/image_view.h"

#include <algorithm>
#include <boost/geometry.hpp>
#include <boost/geometry/geometries/geometries.hpp>
#include <boost/geometry/geometries/point_xy.hpp>

namespace sonoloft {
namespace {

namespace geometry = boost::geometry;
using Point = geometry::model::d2::point_xy<double>;

/// Around the pixels [x0, x1) x [y0, y1).
std::vector<Eigen::Vector2d> rectangle(double x0, double y0, double x1, double y1) {
  x0 -= 0.5, y0 -= 0.5, x1 -= 0.5, y1 -= 0.5;
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

/// The brightest of every pixel.
std::vector<std::uint8_t> brightest(const ImageStack& images) {
  const std::size_t size = std::size_t{images.dims[0]} * images.dims[1];
  std::vector<std::uint8_t> most(size, 0);
  for (std::size_t i = 0; i < images.pixels.size(); ++i) most[i % size] = std::max(most[i % size], images.pixels[i]);
  return most;
}

}  // namespace

std::optional<ImageView> whole_view(const ImageStack& images, const std::optional<ClipRectangle>& clip) {
  const auto [width, height, count] = images.dims;
  ImageView view{0, 0, width, height, {}};
  if (clip) {
    view.x = std::min(clip->origin[0], width);
    view.y = std::min(clip->origin[1], height);
    view.width = std::min(clip->size[0], width - view.x);
    view.height = std::min(clip->size[1], height - view.y);
  }
  if (view.width == 0 || view.height == 0) return std::nullopt;
  view.outline = rectangle(view.x, view.y, view.x + view.width, view.y + view.height);
  return view;
}

std::optional<ImageView> lit_view(const ImageStack& images, const ImageView& view) {
  const std::vector<std::uint8_t> most = brightest(images);
  geometry::model::multi_point<Point> corners;
  for (std::uint32_t y = view.y; y < view.y + view.height; ++y) {
    const auto row = most.begin() + static_cast<std::ptrdiff_t>(std::size_t{y} * images.dims[0]);
    const auto begin = row + view.x, end = begin + view.width;
    const auto lit = [](std::uint8_t value) { return value > 0; };
    const auto first = std::find_if(begin, end, lit);
    if (first == end) continue;
    const auto last = std::find_if(std::make_reverse_iterator(end), std::make_reverse_iterator(first), lit).base();
    for (const Eigen::Vector2d& p :
         rectangle(static_cast<double>(first - row), y, static_cast<double>(last - row), y + 1.0))
      corners.push_back({p.x(), p.y()});
  }
  if (corners.empty()) return std::nullopt;
  geometry::model::ring<Point, false, false> hull;
  geometry::convex_hull(corners, hull);
  const auto box = geometry::return_envelope<geometry::model::box<Point>>(hull);
  ImageView lit;
  for (const Point& p : hull) lit.outline.emplace_back(p.x(), p.y());
  lit.x = static_cast<std::uint32_t>(box.min_corner().x() + 0.5);
  lit.y = static_cast<std::uint32_t>(box.min_corner().y() + 0.5);
  lit.width = static_cast<std::uint32_t>(box.max_corner().x() + 0.5) - lit.x;
  lit.height = static_cast<std::uint32_t>(box.max_corner().y() + 0.5) - lit.y;
  return lit;
}

GreyImage crop(const ImageStack& images, std::size_t index, const ImageView& view) {
  GreyImage part{view.width, view.height, {}};
  part.pixels.reserve(std::size_t{view.width} * view.height);
  for (std::uint32_t y = view.y; y < view.y + view.height; ++y) {
    const std::size_t row = (index * images.dims[1] + y) * images.dims[0] + view.x;
    const auto begin = images.pixels.begin() + static_cast<std::ptrdiff_t>(row);
    part.pixels.insert(part.pixels.end(), begin, begin + view.width);
  }
  return part;
}

}  // namespace sonoloft
