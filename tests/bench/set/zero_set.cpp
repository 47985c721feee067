#include "tests/bench/set/zero_set.h"

#include <Eigen/Geometry>
#include <array>
#include <optional>

#include "core/offline/label_oracle.h"

namespace sonoloft::bench {
namespace {

constexpr std::size_t kEvery = 4;  ///< triangle
constexpr int kSteps = 50;         ///< to a finest cell
constexpr int kHalvings = 20;

/// The nearest change of label along +-normal from a point, in lattice steps, within one.
std::optional<double> nearest_change(const LabelOracle& oracle, const Eigen::Vector3d& from,
                                     const Eigen::Vector3d& normal) {
  const Label here = oracle.label(from);
  for (int k = 1; k <= kSteps; ++k)
    for (const double side : {1.0, -1.0}) {
      double same = side * (k - 1) / kSteps, other = side * k / kSteps;
      if (oracle.label(from + other * normal) == here) continue;
      for (int i = 0; i < kHalvings; ++i) {
        const double middle = (same + other) / 2;
        (oracle.label(from + middle * normal) == here ? same : other) = middle;
      }
      return other;
    }
  return {};
}

}  // namespace

ZeroSet zero_set(const SampleLattice& samples, const MeshSnapshot& live, const IndexedMesh& mesh) {
  const LabelOracle oracle(samples, live);
  ZeroSet result;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += kEvery) {
    std::array<Eigen::Vector3d, 4> points;  // lattice steps
    for (std::size_t i = 0; i < 3; ++i)
      points[i] = (mesh.positions[mesh.triangles[t][i]].cast<double>() - samples.origin_mm()) / samples.spacing_mm();
    points[3] = (points[0] + points[1] + points[2]) / 3;
    const Eigen::Vector3d normal = (points[1] - points[0]).cross(points[2] - points[0]).normalized();
    for (const Eigen::Vector3d& p : points) {
      const std::optional<double> away = nearest_change(oracle, p, normal);
      if (!away) {
        result.missed_mm.push_back(samples.origin_mm() + samples.spacing_mm() * p);
        continue;
      }
      result.distances_mm.push_back(samples.spacing_mm() * std::abs(*away));
      result.points_mm.push_back(samples.origin_mm() + samples.spacing_mm() * (p + *away * normal));
    }
  }
  return result;
}

}  // namespace sonoloft::bench
