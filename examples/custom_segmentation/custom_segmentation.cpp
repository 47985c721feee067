// Your segmentation in front of the reconstruction: grey images with poses in, contours out, surfaces.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <vector>

#include "core/reconstructor/reconstructor.h"

using namespace sonoloft;

namespace {

constexpr int kSize = 96;          // pixels
constexpr double kPixel_mm = 0.8;  // the image's corner is the origin of its frame
constexpr Label kCyst = 1;
using Image = std::vector<std::uint8_t>;  // [kSize * kSize]

bool dark(const Image& image, int x, int y) {
  return image[static_cast<std::size_t>(y * kSize + x)] < 90;
}

/// What a scanner would give: dark where the image's plane cuts a ball of 25 mm, at (38, 38) mm in the image.
Image acquire(double height_mm) {
  Image image(kSize * kSize);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const double r = std::hypot(x * kPixel_mm - 38, y * kPixel_mm - 38, height_mm);
      image[static_cast<std::size_t>(y * kSize + x)] =
          static_cast<std::uint8_t>(r < 25 ? 40 : 160 + (x * 7 + y * 13) % 60);
    }
  return image;
}

/// The borders between dark and bright pixels as closed loops along the pixels' edges, dark on the left.
/// This is the place of your network. @pre the image's own border is bright, dark pixels touch along edges only
void segment(const Image& image, TrackedSlice& slice) {
  using Corner = std::pair<int, int>;
  std::map<Corner, Corner> next;
  for (int y = 1; y < kSize - 1; ++y)
    for (int x = 1; x < kSize - 1; ++x) {
      if (!dark(image, x, y)) continue;
      if (!dark(image, x, y - 1)) next[{x, y}] = {x + 1, y};
      if (!dark(image, x + 1, y)) next[{x + 1, y}] = {x + 1, y + 1};
      if (!dark(image, x, y + 1)) next[{x + 1, y + 1}] = {x, y + 1};
      if (!dark(image, x - 1, y)) next[{x, y + 1}] = {x, y};
    }
  while (!next.empty()) {
    const auto first = static_cast<std::uint32_t>(slice.points.size());
    for (auto at = next.begin(); at != next.end();) {
      const Corner to = at->second;
      slice.points.emplace_back((to.first - 0.5) * kPixel_mm, (to.second - 0.5) * kPixel_mm);
      next.erase(at);
      at = next.find(to);
    }
    slice.contours.push_back({first, static_cast<std::uint32_t>(slice.points.size()) - first, kCyst, false});
  }
  // What lies outside of the image was not seen.
  const double end = (kSize - 1) * kPixel_mm;
  slice.field_of_view = {{0, 0}, {end, 0}, {end, end}, {0, end}};
}

}  // namespace

int main() {
  ReconstructorOptions options;
  options.box = {Eigen::Vector3d::Constant(-60), Eigen::Vector3d::Constant(140)};
  options.spacing_mm = 1.5;
  auto reconstructor = Reconstructor::create(options);
  if (!reconstructor) return std::fprintf(stderr, "%s\n", reconstructor.error().message.c_str()), 1;
  for (int i = 0; i < 25; ++i) {
    const double height_mm = -30 + 2.5 * i;
    TrackedSlice slice;
    slice.id = static_cast<std::uint64_t>(i);
    slice.image_to_reference = Eigen::Translation3d(0, 0, 38 + height_mm);  // what your tracker says
    segment(acquire(height_mm), slice);
    if (const auto added = reconstructor->add(slice); !added)
      return std::fprintf(stderr, "%s\n", added.error().message.c_str()), 1;
  }
  if (const auto updated = reconstructor->update(); !updated)
    return std::fprintf(stderr, "%s\n", updated.error().message.c_str()), 1;
  const IndexedMesh mesh = reconstructor->mesh().indexed();
  double volume_mm3 = 0;  // divergence theorem; the triangles run counter-clockwise seen from the label in front
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const double tetrahedron =
        mesh.positions[a].cast<double>().dot(mesh.positions[b].cast<double>().cross(mesh.positions[c].cast<double>())) /
        6;
    volume_mm3 += mesh.label_back[t] == kCyst ? tetrahedron : -tetrahedron;
  }
  std::printf("%zu triangles, %.1f ml of 65.4 ml\n", mesh.triangles.size(), 1e-3 * volume_mm3);
}
