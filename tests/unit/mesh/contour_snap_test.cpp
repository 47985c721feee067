#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>

#include "core/mesh/surface_extractor.h"

namespace sonoloft::test {
namespace {

/// One brick: label 1 for z <= 3 and outside above, so that the samples put the surface at z = 3.5.
class SlabLattice final : public SampleLattice {
 public:
  explicit SlabLattice(std::vector<ContourPiece> contours) : contours_(std::move(contours)) {
    brick_.palette = {0, 1};
    for (int i = 0; i < kBrickSamples; ++i)
      brick_.label[static_cast<std::size_t>(i)] = i >> 6 <= 3 ? Label{1} : kOutside;
    for (const Label of : brick_.palette)
      for (const Label label : brick_.label) brick_.share.push_back(label == of ? 1.0F : 0.0F);
  }
  [[nodiscard]] const Brick* find(BrickCoord coord) const override { return coord == brick_.coord ? &brick_ : nullptr; }
  [[nodiscard]] std::span<const ContourPiece> contours(BrickCoord) const override { return contours_; }
  [[nodiscard]] Eigen::Vector3d origin_mm() const override { return Eigen::Vector3d::Zero(); }
  [[nodiscard]] double spacing_mm() const override { return 1; }

 private:
  Brick brick_{};
  std::vector<ContourPiece> contours_;
};

std::vector<Eigen::Vector3f> vertices(const std::vector<ContourPiece>& contours) {
  SurfaceExtractor extractor;
  extractor.update(SlabLattice(contours), std::vector<BrickCoord>{{0, 0, 0}}, 1);
  return extractor.snapshot().indexed().positions;
}

const ContourPiece kPiece{{1.3F, 1.2F, 3.2F}, {5.8F, 4.1F, 3.8F}, 0, 1, SliceId{0}, false, false};

double distance(const Eigen::Vector3f& p) {
  const Eigen::Vector3f along = kPiece.b - kPiece.a;
  const float t = std::clamp(along.dot(p - kPiece.a) / along.squaredNorm(), 0.0F, 1.0F);
  return (kPiece.a + t * along - p).norm();
}

}  // namespace

TEST_CASE("mesh: the cells that a contour runs through have their vertices on it, the others stay") {
  int on_contour = 0;
  for (const Eigen::Vector3f& p : vertices({kPiece})) {
    if (distance(p) < 0.05)  // the margin that a vertex keeps from the sides of its cell, in two axes
      ++on_contour;
    else
      CHECK(p.z() == 3.5F);
  }
  CHECK(on_contour == 8);  // the cells of layer 3 that the piece crosses: 5 along x, and 3 steps along y
}

TEST_CASE("mesh: of two contours in a cell the nearer one has the vertex") {
  ContourPiece farther = kPiece;
  farther.a.z() = farther.b.z() = 3.03F;
  const auto alone = vertices({kPiece});
  CHECK(vertices({kPiece, kPiece}) == alone);
  int same = 0;
  for (const auto& both = vertices({farther, kPiece}); const Eigen::Vector3f& p : both) same += distance(p) < 0.05;
  CHECK(same >= 7);  // where the two cross the same side of a cell, the pieces in it may differ
}

TEST_CASE("mesh: a corner of a contour that the mesh would cut off has the vertex of its cell, whatever is nearer") {
  ContourPiece to_corner = kPiece, from_corner{kPiece.b, {6.7F, 1.1F, 3.4F}, 0, 1, SliceId{0}, true, false};
  to_corner.b_is_end = true;
  const auto at_corner = [](const std::vector<Eigen::Vector3f>& points) {
    return std::count_if(points.begin(), points.end(), [](const auto& p) { return (p - kPiece.b).norm() < 1e-4; });
  };
  ContourPiece no_end = from_corner;
  no_end.a_is_end = false;
  CHECK(at_corner(vertices({to_corner, from_corner})) == 1);
  CHECK(at_corner(vertices({from_corner})) == 1);
  CHECK(at_corner(vertices({kPiece, no_end})) == 0);
}

TEST_CASE("mesh: a corner of a contour that the mesh hardly cuts off leaves the vertex where the cells are even") {
  const Eigen::Vector3f corner(2.9F, 2.6F, 3.55F);
  const ContourPiece to{{1.2F, 2.5F, 3.5F}, corner, 0, 1, SliceId{0}, false, true};
  const ContourPiece from{corner, {5.2F, 2.5F, 3.5F}, 0, 1, SliceId{0}, true, false};
  std::vector<float> along;
  for (const Eigen::Vector3f& p : vertices({to, from})) {
    if (std::abs(p.y() - 2.5F) > 0.2F || p.x() < 2 || p.x() > 5) continue;
    along.push_back(p.x());
    CHECK(p.z() > 3.5F);  // on the contour, which is above the samples' surface
  }
  std::ranges::sort(along);
  REQUIRE(along.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) CHECK(std::abs(along[i] - (2.5F + static_cast<float>(i))) < 0.02F);
}

TEST_CASE("mesh: of the corners of contours in a cell the one has the vertex that the mesh would cut off most") {
  const Eigen::Vector3f tip(2.5F, 2.5F, 3.9F), notch(2.4F, 2.3F, 3.5F), outside(2.1F, 4.5F, 3.5F);
  const ContourPiece up{notch, tip, 0, 1, SliceId{0}, true, true}, down{tip, outside, 0, 1, SliceId{0}, true, true};
  for (const auto& pieces : {std::vector{up, down}, std::vector{down, up}}) {
    const auto points = vertices(pieces);
    CHECK(std::any_of(points.begin(), points.end(), [&](const auto& p) { return (p - tip).norm() < 1e-4; }));
  }
}

TEST_CASE("mesh: a contour of other labels moves nothing") {
  ContourPiece other = kPiece;
  other.upper = 2;
  CHECK(vertices({other}) == vertices({}));
}

}  // namespace sonoloft::test
