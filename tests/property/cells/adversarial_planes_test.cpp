#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <random>

#include "core/cells/cell_complex.h"
#include "tests/support/planes.h"

using namespace sonoloft;

namespace {

/// One sequence: a box, and planes that are hard on the complex in it. All of it comes from the seed.
class Sequence {
 public:
  explicit Sequence(unsigned seed) : rng_(seed) {
    size_mm_ = std::array{1e-3, 1.0, 100.0, 1e5}[rng_() % 4];
    Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5 * size_mm_);
    if (rng_() % 4 == 0) half.z() *= 1e-3;
    if (rng_() % 3 == 0) shift_ = 1e5 * test::random_direction(rng_);
    box_ = {shift_ - half, shift_ + half};
  }

  /// Runs it. @return slices that were refused
  std::size_t run(CellComplex& complex, int slices) {
    std::size_t refused = 0;
    for (int i = 0; i < slices; ++i) {
      frames_.push_back(next(complex));
      Section section = test::section_of_discs(frames_.back(), {{{0, 0}, size_mm_ * uniform(0.05, 0.5), 1}}, 12);
      if (rng_() % 3 == 0) test::bound_view(section);
      refused += !complex.insert(section);
    }
    return refused;
  }

  [[nodiscard]] const Eigen::AlignedBox3d& box() const { return box_; }
  [[nodiscard]] double gap_mm() { return size_mm_ * (rng_() % 2 == 0 ? 1e-14 : 1e-4); }

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(rng_); }
  const Eigen::Isometry3d& earlier() { return frames_[rng_() % frames_.size()]; }

  Eigen::Isometry3d next(const CellComplex& complex) {
    if (frames_.empty()) return free_plane();
    switch (rng_() % 8) {
      case 0:
        return near_earlier();
      case 1:
        return through_corners(complex);
      case 2:
        return along_the_box();
      case 3: {  // through the line where two earlier ones meet, or a new plane through a point of one
        const Eigen::Isometry3d& f = earlier();
        return test::frame_at(f.translation(),
                              (earlier().linear().col(2) * uniform(0, 1) + f.linear().col(2)).normalized());
      }
      case 4: {  // parallel
        const Eigen::Isometry3d& f = earlier();
        return test::frame_at(f.translation() + f.linear().col(2) * size_mm_ * uniform(-0.5, 0.5), f.linear().col(2));
      }
      case 5:  // through the middle of the box: many planes through one point, exactly so without a shift
        return test::frame_at(shift_, test::random_direction(rng_));
      default:
        return free_plane();
    }
  }

  Eigen::Isometry3d free_plane() {
    Eigen::Isometry3d frame = test::random_frame(rng_, 0.4 * size_mm_);
    frame.translation() += shift_;
    return frame;
  }

  /// Coincident, turned round, or off by 1e-12 of the size (which may be nothing to a double), or by 1e-12..1 of it.
  Eigen::Isometry3d near_earlier() {
    const Eigen::Isometry3d& f = earlier();
    const Eigen::Vector3d normal = f.linear().col(2);
    switch (rng_() % 4) {
      case 0:
        return f;
      case 1:
        return test::frame_at(f.translation(), -normal);
      case 2:
        return test::frame_at(f.translation() + 1e-12 * size_mm_ * normal, normal);
      default: {
        const double tiny = std::pow(10.0, uniform(-12, 0));
        return test::frame_at(f.translation() + tiny * size_mm_ * normal,
                              (normal + tiny * test::random_direction(rng_)).normalized());
      }
    }
  }

  /// Through 1, 2 (an edge or a diagonal) or 3 corners of cells.
  Eigen::Isometry3d through_corners(const CellComplex& complex) {
    const Eigen::Vector3d a = corner(complex);
    Eigen::Vector3d normal = test::random_direction(rng_);
    const auto count = rng_() % 3;
    if (count > 0) {
      const Eigen::Vector3d along = corner(complex) - a;
      const Eigen::Vector3d other = count == 1 ? normal : Eigen::Vector3d(corner(complex) - a);
      const Eigen::Vector3d across = along.cross(other);
      if (across.norm() > 1e-9 * size_mm_ * size_mm_) normal = across.normalized();
    }
    return test::frame_at(a, normal);
  }

  Eigen::Vector3d corner(const CellComplex& complex) {
    complex.faces(CellId{static_cast<std::uint32_t>(rng_() % complex.cell_count())}, faces_);
    for (;;) {
      const CellFace& face = faces_[rng_() % faces_.size()];
      if (face.polygon->empty()) continue;
      const FaceEdge& edge = (*face.polygon)[rng_() % face.polygon->size()];
      return *face.image_to_reference * Eigen::Vector3d(edge.a.x(), edge.a.y(), 0);
    }
  }

  /// Through the box's middle or corners and edges, along its axes and diagonals.
  Eigen::Isometry3d along_the_box() {
    const auto axis = static_cast<int>(rng_() % 3);
    Eigen::Vector3d normal = Eigen::Vector3d::Unit(axis);
    if (rng_() % 2 == 0) normal = Eigen::Vector3d(1, 1, rng_() % 2 == 0 ? 0 : 1);
    return test::frame_at(rng_() % 2 == 0 ? shift_ : box_.max(), normal.normalized());
  }

  std::mt19937 rng_;
  double size_mm_;
  Eigen::Vector3d shift_ = Eigen::Vector3d::Zero();
  Eigen::AlignedBox3d box_;
  std::vector<Eigen::Isometry3d> frames_;
  std::vector<CellFace> faces_;
};

}  // namespace

TEST_CASE("cells: 500 adversarial plane sequences give valid complexes, in tiny and in huge boxes, near and far") {
  std::size_t cells = 0, refused = 0, largest = 0;
  for (unsigned seed = 0; seed < 500; ++seed) {
    CAPTURE(seed);
    Sequence sequence(seed);
    CellComplex complex(sequence.box(), sequence.gap_mm());
    refused += sequence.run(complex, 16);
    CHECK(complex.validate() == "");
    cells += complex.cell_count();
    largest = std::max(largest, complex.cell_count());
  }
  MESSAGE(cells << " cells in 500 complexes, " << largest << " in the largest; " << refused
                << " of 8000 slices refused as duplicates or out of the box");
}
