#include "core/segmentation/image_view.h"

#include <doctest/doctest.h>

using namespace sonoloft;
using Eigen::Vector2d;

namespace {

ImageStack black(std::uint32_t width, std::uint32_t height, std::uint32_t count) {
  ImageStack images;
  images.dims = {width, height, count};
  images.pixels.assign(std::size_t{width} * height * count, 0);
  return images;
}

double area(const std::vector<Vector2d>& outline) {
  double twice = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vector2d &a = outline[i], &b = outline[(i + 1) % outline.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

}  // namespace

TEST_CASE("view: the clip rectangle is cut to the images") {
  const ImageStack images = black(20, 10, 3);
  const auto whole = whole_view(images, std::nullopt);
  REQUIRE(whole);
  CHECK(area(whole->outline) == 200);
  CHECK(whole->outline[0] == Vector2d(-0.5, -0.5));
  const auto clipped = whole_view(images, ClipRectangle{{15, 2}, {100, 4}});
  REQUIRE(clipped);
  CHECK(clipped->x == 15);
  CHECK(clipped->width == 5);
  CHECK(clipped->height == 4);
  CHECK(area(clipped->outline) == 20);
  CHECK_FALSE(whole_view(images, ClipRectangle{{20, 0}, {5, 5}}));
  CHECK_FALSE(whole_view(black(0, 0, 3), std::nullopt));
}

TEST_CASE("view: what is not black in every image is hulled, within what is looked at") {
  ImageStack images = black(40, 30, 2);
  const auto light = [&](std::size_t image, std::size_t x, std::size_t y) {
    images.pixels[(image * 30 + y) * 40 + x] = 9;
  };
  const auto whole = whole_view(images, std::nullopt);
  CHECK_FALSE(lit_view(images, *whole));
  light(0, 20, 5);
  light(1, 10, 20);
  light(1, 30, 20);
  const auto lit = lit_view(images, *whole);
  REQUIRE(lit);
  CHECK(lit->x == 10);
  CHECK(lit->y == 5);
  CHECK(lit->width == 21);
  CHECK(lit->height == 16);
  // A triangle of 20 x 15 between the pixels' middles, widened by half a pixel on every side.
  CHECK(area(lit->outline) == doctest::Approx(150 + 20 + 15 + 1));
  CHECK(crop(images, 1, *lit).at(0, 15) == 9);
  CHECK(crop(images, 0, *lit).at(10, 0) == 9);
  const auto right = lit_view(images, *whole_view(images, ClipRectangle{{25, 0}, {15, 30}}));
  REQUIRE(right);
  CHECK(area(right->outline) == 1);
}
