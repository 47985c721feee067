#include "tests/support/bodies/true_surface.h"

#include <algorithm>
#include <cmath>

#include "core/mesh/surface_extractor.h"
#include "tests/support/mesh/synthetic_lattice.h"

namespace sonoloft::test {
namespace {

constexpr int kSteps = 160, kMargin = 3, kLabels = 4;
constexpr int kParts = 6;  ///< of the cube of two steps around a point, along each axis: wide enough that shares are
                           ///< linear between two points at a flat border

/// What the corners and the middle of the cube around a point do not show is not there.
bool one_label_around(const device_sim::Phantom& body, const Eigen::Vector3d& p, double step, Label label) {
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d to(corner & 1 ? step : -step, corner & 2 ? step : -step, corner & 4 ? step : -step);
    if (body.label_at(p + to) != label) return false;
  }
  return true;
}

}  // namespace

IndexedMesh true_surface(const device_sim::Phantom& body) {
  const Eigen::AlignedBox3d box = body.bounds();
  const double step = box.sizes().maxCoeff() / kSteps;
  const Eigen::Vector3d origin = box.min().array() - kMargin * step;
  const auto shares_at = [&](const Eigen::Vector3i& point, std::span<float> shares) {
    const Eigen::Vector3d p = origin + step * point.cast<double>();
    const Label label = body.label_at(p);
    if (one_label_around(body, p, step, label)) {
      shares[label] = 1;
      return;
    }
    for (int part = 0; part < kParts * kParts * kParts; ++part) {
      const Eigen::Vector3d at(part % kParts, part / kParts % kParts, part / (kParts * kParts));
      const Eigen::Vector3d to = (at.array() + 0.5) * 2 / kParts - 1;
      shares[body.label_at(p + step * to)] += 1.0F / (kParts * kParts * kParts);
    }
  };
  const SyntheticLattice lattice(kSteps + 2 * kMargin, kLabels, shares_at, origin, step);
  SurfaceExtractor extractor;
  extractor.update(lattice, lattice.bricks(), 1);
  return extractor.snapshot().indexed();
}

}  // namespace sonoloft::test
