#include "host/apps/picture/picture.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "core/io/meshes/mesh_files.h"
#include "tests/support/mesh/solid_meshes.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#include <stb/stb_image.h>

using namespace sonoloft;
using namespace sonoloft::test;
using Eigen::Vector3d;

namespace {

PictureOptions small(const Vector3d& look = {1, 2, -1}) {
  PictureOptions options;
  options.width_px = 240;
  options.height_px = 180;
  options.look = look;
  return options;
}

Picture drawn(const IndexedMesh& mesh, const PictureOptions& options, int threads = 1) {
  auto picture = draw(mesh, options, threads);
  REQUIRE(picture);
  return *picture;
}

Eigen::Vector3d pixel(const Picture& picture, int x, int y) {
  const auto* rgb = &picture.rgb[3 * (std::size_t(x) + std::size_t(picture.width_px) * std::size_t(y))];
  return {double(rgb[0]), double(rgb[1]), double(rgb[2])};
}

/// What is left of a colour without its grey part, scaled to 1: the hue, whatever the light.
Eigen::Vector3d hue(const Eigen::Vector3d& rgb) {
  const Eigen::Vector3d color = rgb.array() - rgb.mean();
  return color / std::max(1.0, color.norm());
}

Eigen::Vector3d hue_of(Label label) {
  const auto rgb = label_colour(label);
  return hue({double(rgb[0]), double(rgb[1]), double(rgb[2])});
}

/// Whether a pixel shows a label's colour: nearer to its hue than to the other's.
bool shows(const Picture& picture, int x, int y, Label label, Label other) {
  const Eigen::Vector3d seen = hue(pixel(picture, x, y));
  return (seen - hue_of(label)).norm() < (seen - hue_of(other)).norm();
}

/// The rows and columns on which something but the background is seen. The background is even along a row.
struct Extent {
  int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1, pixels = 0;
};

Extent extent(const Picture& picture) {
  Extent e;
  for (int y = 0; y < picture.height_px; ++y) {
    for (int x = 0; x < picture.width_px; ++x) {
      if ((pixel(picture, x, y) - pixel(picture, 0, y)).norm() < 8) continue;
      e.left = std::min(e.left, x), e.right = std::max(e.right, x);
      e.top = std::min(e.top, y), e.bottom = std::max(e.bottom, y);
      ++e.pixels;
    }
  }
  return e;
}

}  // namespace

TEST_CASE("picture: the same mesh gives the same bytes with any number of threads") {
  const IndexedMesh mesh = together(sphere_mesh({0, 0, 0}, 10, 5), sphere_mesh({6, 4, 5}, 7, 4, 0, 2));
  const Picture one = drawn(mesh, small()), again = drawn(mesh, small()), four = drawn(mesh, small(), 4);
  CHECK(one.rgb.size() == 3u * 240 * 180);
  CHECK(one.rgb == again.rgb);
  CHECK(one.rgb == four.rgb);
}

TEST_CASE("picture: a sphere is a disc that fills the picture and does not touch its border") {
  for (const Vector3d& look : {Vector3d(1, 0, 0), Vector3d(-0.3, 0.5, -0.8), Vector3d(0, -1, 0.2)}) {
    const Extent e = extent(drawn(sphere_mesh({100, -50, 20}, 10, 4), small(look)));
    const double width = e.right - e.left + 1, height = e.bottom - e.top + 1;
    MESSAGE("disc of ", width, " x ", height, " pixels, filled ", e.pixels / (width * height));
    CHECK(e.top >= 2);
    CHECK(e.bottom <= 177);
    CHECK(height > 150);
    CHECK(std::abs(width - height) <= 2);
    CHECK(std::abs(e.pixels / (width * height) - 0.7854) < 0.02);
  }
}

TEST_CASE("picture: a long thing across fills the width instead") {
  const Extent e = extent(drawn(box_mesh({-50, -1, -1}, {50, 1, 1}), small({0, 1, 0})));
  CHECK(e.left >= 2);
  CHECK(e.right <= 237);
  CHECK(e.right - e.left > 200);
}

TEST_CASE("picture: the nearer of two things hides the farther, from either side and in either order") {
  const IndexedMesh low = square_mesh({0, 0, 0}, 10, 0, 1), high = square_mesh({0, 0, 4}, 10, 0, 2);
  for (const IndexedMesh& mesh : {together(low, high), together(high, low)}) {
    PictureOptions options = small({0, 0, -1});
    options.up = {0, 1, 0};
    CHECK(shows(drawn(mesh, options), 120, 90, 2, 1));
    options.look = {0, 0, 1};
    CHECK(shows(drawn(mesh, options), 120, 90, 1, 2));
  }
}

TEST_CASE("picture: where two spheres pierce each other each shows on its own side") {
  const IndexedMesh mesh = together(sphere_mesh({-6, 0, 0}, 8, 5, 0, 1), sphere_mesh({6, 0, 0}, 8, 5, 0, 2));
  const Picture picture = drawn(mesh, small({0, 1, 0}));
  int wrong = 0, checked = 0;
  for (int x = 40; x < 200; ++x) {
    if (std::abs(x - 120) < 4) continue;
    ++checked;
    wrong += !shows(picture, x, 90, x < 120 ? 1 : 2, x < 120 ? 2 : 1);
  }
  CHECK(checked > 150);
  CHECK(wrong == 0);
}

TEST_CASE("picture: a border between two labels shows the one behind it") {
  // A wall between labels 1 (below) and 2 (above), nothing else.
  const IndexedMesh wall = square_mesh({0, 0, 0}, 10, 2, 1);
  PictureOptions options = small({0, 0, -1});
  options.up = {0, 1, 0};
  CHECK(shows(drawn(wall, options), 120, 90, 1, 2));
  options.look = {0, 0, 1};
  CHECK(shows(drawn(wall, options), 120, 90, 2, 1));
}

TEST_CASE("picture: glass lets the label inside show through") {
  const IndexedMesh nested = together(sphere_mesh({0, 0, 0}, 10, 5, 0, 1), sphere_mesh({0, 0, 0}, 5, 4, 1, 2));
  PictureOptions options = small();
  CHECK(shows(drawn(nested, options), 120, 90, 1, 2));
  options.transparent = {1};
  const Picture glass = drawn(nested, options);
  CHECK(shows(glass, 120, 90, 2, 1));
  CHECK(shows(glass, 60, 90, 1, 2));
}

TEST_CASE("picture: a cut shows the labels that it passes as flat faces") {
  const IndexedMesh nested = together(sphere_mesh({0, 0, 0}, 10, 5, 0, 1), sphere_mesh({0, 0, 0}, 5, 5, 1, 2));
  PictureOptions options = small({0, 1, 0});
  options.cut = Cut{{0, 0, 0}, {0, -1, 0}};
  const Picture picture = drawn(nested, options);
  int wrong = 0;
  for (int y = 20; y < 160; ++y) {
    // Half a cut sphere's picture: the inner label within half of the outer disc's radius.
    const double share = std::abs(y - 89.5) / 90;
    if (share < 0.35) wrong += !shows(picture, 120, y, 2, 1);
    if (share > 0.55 && share < 0.75) wrong += !shows(picture, 120, y, 1, 2);
  }
  CHECK(wrong == 0);
  CHECK((pixel(picture, 120, 90) - pixel(picture, 128, 80)).norm() == 0);  // flat
  options.cut = Cut{{0, 0, 0}, {0, 1, 0}};
  CHECK(shows(drawn(nested, options), 120, 90, 1, 2));  // the half behind is gone: the outside is seen
}

TEST_CASE("picture: light and dark differ in the background, not in the surface") {
  const IndexedMesh sphere = sphere_mesh({0, 0, 0}, 10, 4);
  PictureOptions options = small();
  const Picture light = drawn(sphere, options);
  options.dark = true;
  const Picture dark = drawn(sphere, options);
  CHECK(pixel(light, 0, 90).minCoeff() > 180);
  CHECK(pixel(dark, 0, 90).maxCoeff() < 80);
  CHECK(pixel(light, 120, 90) == pixel(dark, 120, 90));
}

TEST_CASE("picture: a legend puts each label's colour and some ink into the corner") {
  PictureOptions options = small();
  const IndexedMesh sphere = sphere_mesh({0, 0, 0}, 10, 3);
  const Picture without = drawn(sphere, options);
  options.legend = {{1, "liver"}, {2, "vessel (\x80?)"}};
  REQUIRE(options.labels.add(2, "vessel", {9, 80, 255}));
  const Picture with = drawn(sphere, options);
  int squares[2] = {0, 0}, changed = 0;
  for (int y = 90; y < 180; ++y) {
    for (int x = 0; x < 120; ++x) {
      changed += pixel(with, x, y) != pixel(without, x, y);
      for (Label label : {Label{1}, Label{2}}) {
        const auto rgb = options.labels.colour(label);
        squares[label - 1] += pixel(with, x, y) == Eigen::Vector3d(rgb[0], rgb[1], rgb[2]);
      }
    }
  }
  CHECK(squares[0] >= 64);
  CHECK(squares[1] >= 64);
  CHECK(changed > 200);
}

TEST_CASE("picture: a written PNG reads back byte for byte") {
  const Picture picture = drawn(sphere_mesh({0, 0, 0}, 10, 4), small());
  const auto path = std::filesystem::temp_directory_path() / "sonoloft_picture_test.png";
  REQUIRE(write_png(picture, path));
  int width = 0, height = 0, channels = 0;
  stbi_uc* const data = stbi_load(path.c_str(), &width, &height, &channels, 3);
  REQUIRE(data != nullptr);
  CHECK(width == 240);
  CHECK(height == 180);
  CHECK(std::equal(picture.rgb.begin(), picture.rgb.end(), data));
  stbi_image_free(data);
  std::filesystem::remove(path);
  const auto refused = write_png(picture, "/no/such/folder/picture.png");
  REQUIRE(!refused);
  CHECK(refused.error().code == ErrorCode::io_failed);
}

TEST_CASE("picture: bad input is refused with its reason, degenerate input is drawn") {
  const IndexedMesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  const auto code = [](const auto& result) { return result ? 0 : static_cast<int>(result.error().code); };
  CHECK(code(draw({}, small(), 1)) == int(ErrorCode::empty_input));
  IndexedMesh bad = box;
  bad.positions[2].x() = std::numeric_limits<float>::infinity();
  CHECK(code(draw(bad, small(), 1)) == int(ErrorCode::non_finite));
  for (const Vector3d& look : {Vector3d(0, 0, 0), Vector3d(0, 0, -5), Vector3d(std::nan(""), 0, 1)}) {
    CHECK(code(draw(box, small(look), 1)) == int(ErrorCode::invalid_argument));
  }
  PictureOptions options = small();
  options.width_px = 0;
  CHECK(code(draw(box, options, 1)) == int(ErrorCode::invalid_argument));
  options = small();
  options.cut = Cut{{0, 0, 0}, {0, 0, 0}};
  CHECK(code(draw(box, options, 1)) == int(ErrorCode::invalid_argument));
  // All in one point, edge-on, all cut away, huge and tiny: no crash, a picture.
  IndexedMesh point = box;
  for (auto& p : point.positions) p = {5, 5, 5};
  CHECK(draw(point, small(), 1));
  CHECK(draw(square_mesh({0, 0, 0}, 5), small({1, 0, 0}), 1));
  options.cut = Cut{{0, 0, -10}, {0, 0, 1}};
  CHECK(draw(box, options, 1));
  CHECK(extent(drawn(box_mesh({1e6, 1e6, 1e6}, {1e6 + 8, 1e6 + 8, 1e6 + 8}), small())).pixels > 5000);
  CHECK(extent(drawn(box_mesh({-1e-4, -1e-4, -1e-4}, {1e-4, 1e-4, 1e-4}), small())).pixels > 5000);
  CHECK(extent(drawn(box_mesh({-1e15, -1e15, -1e15}, {1e15, 1e15, 1e15}), small())).pixels > 5000);
}
