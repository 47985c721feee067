#include "host/apps/measure/agreement.h"

#include <cstdint>
#include <map>
#include <random>

#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

std::vector<Eigen::Vector3d> points_in(const Eigen::AlignedBox3d& box) {
  std::mt19937_64 bits(1);
  std::vector<Eigen::Vector3d> points(kAgreementPoints);
  for (Eigen::Vector3d& p : points)  // not by the standard's distributions, which differ between libraries
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = box.min()[axis] + static_cast<double>(bits() >> 11) * 0x1p-53 * box.sizes()[axis];
  return points;
}

}  // namespace

double Agreement::mean_iou() const {
  double sum = 0;
  for (const LabelAgreement& label : labels) sum += label.iou();
  return labels.empty() ? 0 : sum / static_cast<double>(labels.size());
}

Agreement agreement(const Eigen::AlignedBox3d& box, const std::function<Label(const Eigen::Vector3d&)>& mesh,
                    const std::function<Label(const Eigen::Vector3d&)>& truth, int threads) {
  constexpr std::size_t kGrain = 1024;
  const std::vector<Eigen::Vector3d> points = points_in(box);
  std::vector<Label> in_mesh(points.size()), in_truth(points.size());
  parallel_for(points.size(), kGrain, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      in_mesh[i] = mesh(points[i]);
      in_truth[i] = truth(points[i]);
    }
  });
  std::map<Label, LabelAgreement> labels;
  const auto counts = [&](Label label) -> LabelAgreement& {
    return labels.try_emplace(label, LabelAgreement{label, 0, 0, 0}).first->second;
  };
  std::size_t common = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    ++counts(in_mesh[i]).mesh;
    ++counts(in_truth[i]).truth;
    if (in_mesh[i] != in_truth[i]) continue;
    ++counts(in_mesh[i]).common;
    ++common;
  }
  labels.erase(kOutside);
  Agreement result{{}, 1 - static_cast<double>(common) / static_cast<double>(points.size())};
  for (const auto& [label, of] : labels) result.labels.push_back(of);
  return result;
}

}  // namespace sonoloft
