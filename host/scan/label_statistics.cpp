#include "host/scan/label_statistics.h"

#include <Eigen/Geometry>
#include <map>

namespace sonoloft {
namespace {

constexpr double kMlPerMm3 = 1e-3;

struct Sum {
  std::size_t triangles = 0;
  double volume_ml = 0;
};
using Sums = std::map<Label, Sum>;

std::vector<LabelStatistics> listed(const Sums& sums) {
  std::vector<LabelStatistics> list;
  for (const auto& [label, sum] : sums) list.push_back({label, sum.triangles, sum.volume_ml});
  return list;
}

std::vector<LabelStatistics> sum_up(const MeshChunk& chunk, const Eigen::Vector3d& centre_mm) {
  Sums sums;
  for (std::size_t t = 0; t < chunk.triangles.size(); ++t) {
    const auto corner = [&](std::size_t i) -> Eigen::Vector3d {
      return chunk.positions[chunk.triangles[t][i]].cast<double>() - centre_mm;
    };
    // Positive where the normal points away from the centre; it points out of the label at the back.
    const double volume_ml = corner(0).dot(corner(1).cross(corner(2))) / 6 * kMlPerMm3;
    const auto count = [&](Label label, double signed_ml) {
      if (label == kOutside) return;
      sums[label].triangles += 1;
      sums[label].volume_ml += signed_ml;
    };
    count(chunk.label_back[t], volume_ml);
    count(chunk.label_front[t], -volume_ml);
  }
  return listed(sums);
}

}  // namespace

std::vector<LabelStatistics> LabelStatisticsKeeper::update(const MeshSnapshot& mesh,
                                                           std::span<const BrickCoord> changed) {
  for (const BrickCoord& coord : changed) parts_.erase(coord);
  Sums sums;
  for (const auto& chunk : mesh.chunks) {
    const auto [part, missing] = parts_.try_emplace(chunk->coord);
    if (missing) part->second = sum_up(*chunk, centre_mm_);
    for (const LabelStatistics& s : part->second) {
      sums[s.label].triangles += s.triangles;
      sums[s.label].volume_ml += s.volume_ml;
    }
  }
  return listed(sums);
}

}  // namespace sonoloft
