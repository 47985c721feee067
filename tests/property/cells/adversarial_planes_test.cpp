#include <doctest/doctest.h>

#include <random>

#include "core/cells/cell_complex.h"
#include "tests/support/planes.h"

using namespace sonoloft;

namespace {

/// Planes that are hard on a complex: near earlier ones by 10^-12..1, through their common lines and points, parallel,
/// axis-aligned through corners of the box.
Eigen::Isometry3d nasty_frame(std::mt19937& rng, const std::vector<Eigen::Isometry3d>& earlier, double size) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const auto pick = [&]() -> const Eigen::Isometry3d& { return earlier[rng() % earlier.size()]; };
  const int kind = earlier.empty() ? 0 : static_cast<int>(rng() % 6);
  const double tiny = size * std::pow(10.0, -12.0 * uniform(rng));
  switch (kind) {
    case 1: {  // all but coincident
      const Eigen::Isometry3d& f = pick();
      return test::frame_at(f.translation() + f.linear().col(2) * tiny,
                            (f.linear().col(2) + test::random_direction(rng) * tiny / size).normalized());
    }
    case 2: {  // parallel
      const Eigen::Isometry3d& f = pick();
      return test::frame_at(f.translation() + f.linear().col(2) * size * (uniform(rng) - 0.5), f.linear().col(2));
    }
    case 3: {  // through the common line of two
      const Eigen::Vector3d a = pick().linear().col(2);
      const Eigen::Isometry3d& f = pick();
      const Eigen::Vector3d mixed = a * uniform(rng) + f.linear().col(2);
      return test::frame_at(f.translation(), mixed.normalized());
    }
    case 4: {  // along an axis, through the box's middle or corner
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(static_cast<int>(rng() % 3));
      return test::frame_at(Eigen::Vector3d::Constant(rng() % 2 == 0 ? 0.0 : 0.5 * size), axis);
    }
    case 5: {  // through the middle, diagonal: meets edges and corners of the box
      Eigen::Vector3d diagonal(1, 1, 0);
      if (rng() % 2 == 0) diagonal.z() = 1;
      return test::frame_at(Eigen::Vector3d::Zero(), diagonal.normalized());
    }
    default:
      return test::random_frame(rng, 0.4 * size);
  }
}

}  // namespace

TEST_CASE("cells: 150 adversarial plane sequences give valid complexes, at any gap and far from the origin") {
  std::size_t cells = 0;
  std::size_t refused = 0;
  for (unsigned seed = 0; seed < 150; ++seed) {
    std::mt19937 rng(seed);
    const double size = seed % 3 == 0 ? 1.0 : 100.0;
    const Eigen::Vector3d shift = seed % 4 == 0 ? Eigen::Vector3d::Constant(1e5) : Eigen::Vector3d::Zero();
    const double gap = seed % 2 == 0 ? 1e-14 * size : 1e-3 * size;
    const Eigen::AlignedBox3d box(shift - Eigen::Vector3d::Constant(0.5 * size),
                                  shift + Eigen::Vector3d::Constant(0.5 * size));
    CellComplex complex(box, gap);
    std::vector<Eigen::Isometry3d> frames;
    for (int i = 0; i < 14; ++i) {
      frames.push_back(nasty_frame(rng, frames, size));
      Eigen::Isometry3d frame = frames.back();
      frame.translation() += shift;
      refused += !complex.insert(test::section_of_discs(frame, {{{0, 0}, 0.2 * size, 1}}, 12));
    }
    CHECK(complex.validate() == "");
    cells += complex.cell_count();
  }
  MESSAGE(cells << " cells in 150 complexes; " << refused << " slices refused as duplicates or out of the box");
}
