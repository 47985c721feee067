#include "tests/bench/unknown/pieces.h"

#include <array>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <unordered_map>

#include "core/slice/section_raster.h"
#include "tests/bench/support/reconstruction.h"

namespace sonoloft::bench {
namespace {

constexpr int kReach = 3;  ///< pixels

/// Vertices by cube of `step`.
class Near {
 public:
  Near(const std::vector<Eigen::Vector3f>& points, double step) : points_(points), step_(step) {
    for (std::uint32_t i = 0; i < points.size(); ++i) cubes_[key(cube(points[i].cast<double>()))].push_back(i);
  }
  /// The nearest vertex for which `is_one` holds within a cube's width, or none.
  template <class IsOne>
  [[nodiscard]] std::optional<std::uint32_t> nearest(const Eigen::Vector3d& p, IsOne is_one) const {
    const Eigen::Vector3i at = cube(p);
    std::optional<std::uint32_t> found;
    double least = step_ * step_;
    for (int k = 0; k < 27; ++k) {
      const auto it = cubes_.find(key(at + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)));
      if (it == cubes_.end()) continue;
      for (const std::uint32_t i : it->second)
        if (const double d2 = (points_[i].cast<double>() - p).squaredNorm(); d2 < least && is_one(i)) {
          least = d2;
          found = i;
        }
    }
    return found;
  }

 private:
  [[nodiscard]] Eigen::Vector3i cube(const Eigen::Vector3d& p) const { return (p / step_).array().floor().cast<int>(); }
  static std::uint64_t key(const Eigen::Vector3i& c) {
    const auto bits = [](int v) { return static_cast<std::uint64_t>(v + (1 << 20)) & 0x1FFFFF; };
    return bits(c.x()) | bits(c.y()) << 21 | bits(c.z()) << 42;
  }
  const std::vector<Eigen::Vector3f>& points_;
  double step_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cubes_;
};

struct Pixel {
  Eigen::Vector3d point;
  Label label;
};

std::vector<Pixel> known_pixels(std::span<const TrackedSlice> slices, const Eigen::AlignedBox3d& box, double pixel_mm) {
  std::vector<Pixel> pixels;
  for (const TrackedSlice& slice : slices) {
    const Section section = or_exit(make_section(slice));
    const SectionRaster raster = rasterize(section, pixel_mm, box);
    for (int y = 0; y < raster.height; ++y)
      for (int x = 0; x < raster.width; ++x) {
        if (raster.at(x, y) == kUnknown) continue;
        const Eigen::Vector2d p = raster.point(x, y);
        pixels.push_back({section.image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0), raster.at(x, y)});
      }
  }
  return pixels;
}

Pieces pieces_of(Label label, const IndexedMesh& mesh, const Near& vertices, std::span<const Pixel> pixels) {
  std::vector<std::uint32_t> parent(mesh.positions.size());
  std::vector<char> of_label(parent.size(), 0);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const auto for_each_triangle = [&](auto visit) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      if (mesh.label_front[t] == label || mesh.label_back[t] == label)
        visit(mesh.triangles[t], mesh.label_back[t] == label ? 1.0 : -1.0);
  };
  for_each_triangle([&](const std::array<std::uint32_t, 3>& t, double) {
    for (const std::uint32_t v : t) {
      parent[root(v)] = root(t[0]);
      of_label[v] = 1;
    }
  });
  std::map<std::uint32_t, double> volume;  // by root; hollows have less than none
  for_each_triangle([&](const std::array<std::uint32_t, 3>& t, double side) {
    const auto at = [&](std::size_t k) { return Eigen::Vector3d(mesh.positions[t[k]].cast<double>()); };
    volume[root(t[0])] += side * at(0).dot(at(1).cross(at(2)));
  });
  std::set<std::uint32_t> supported;
  for (const Pixel& pixel : pixels) {
    const auto vertex = vertices.nearest(pixel.point, [&](std::uint32_t i) { return of_label[i] != 0; });
    if (vertex && (volume[root(*vertex)] > 0) == (pixel.label == label)) supported.insert(root(*vertex));
  }
  return {volume.size(), volume.size() - supported.size()};
}

}  // namespace

Pieces count_pieces(const IndexedMesh& mesh, std::span<const TrackedSlice> slices, double pixel_mm) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& p : mesh.positions) box.extend(p.cast<double>());
  const double reach_mm = kReach * pixel_mm;
  const Near vertices(mesh.positions, reach_mm);
  const Eigen::AlignedBox3d around(box.min().array() - reach_mm, box.max().array() + reach_mm);
  const std::vector<Pixel> pixels = known_pixels(slices, around, pixel_mm);
  std::set<Label> labels(mesh.label_front.begin(), mesh.label_front.end());
  labels.insert(mesh.label_back.begin(), mesh.label_back.end());
  labels.erase(kOutside);
  Pieces sum;
  for (const Label label : labels) {
    const Pieces of_label = pieces_of(label, mesh, vertices, pixels);
    sum.all += of_label.all;
    sum.spurious += of_label.spurious;
  }
  return sum;
}

}  // namespace sonoloft::bench
