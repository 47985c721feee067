#include "device_sim/probe/label_noise.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "device_sim/probe/field_of_view.h"

namespace sonoloft::device_sim {
namespace {

std::span<const Eigen::Vector2d> points_of(const PhantomSection& section, const SectionLoop& loop) {
  return std::span(section.points).subspan(loop.first, loop.count);
}

Label label_in(const PhantomSection& section, const Eigen::Vector2d& p) {
  double smallest = std::numeric_limits<double>::infinity();
  Label label = kOutside;
  for (const SectionLoop& loop : section.loops) {
    const double area = std::abs(signed_area(points_of(section, loop)));
    if (area >= smallest || !encloses(points_of(section, loop), p)) continue;
    smallest = area;
    label = loop.label;
  }
  return label;
}

std::vector<Label> labels_of(const PhantomSection& section) {
  std::vector<Label> labels{kOutside};
  for (const SectionLoop& loop : section.loops) labels.push_back(loop.label);
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  return labels;
}

Eigen::Vector2d random_point_in(std::span<const Eigen::Vector2d> view, Random& random) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& p : view) box.extend(p);
  for (;;) {
    const double x = random.uniform(), y = random.uniform();
    const Eigen::Vector2d p = box.min() + Eigen::Vector2d(x, y).cwiseProduct(box.sizes());
    if (encloses(view, p)) return p;
  }
}

}  // namespace

Displacement::Displacement(double rms_mm, double correlation_mm, Random& random)
    : amplitude_mm_(rms_mm / std::sqrt(kWaves)) {
  for (Wave& wave : waves_) {
    const Eigen::Vector3d n = random.normal3() / correlation_mm;
    wave = {n.head<2>(), 2 * std::numbers::pi * random.uniform(), 2 * std::numbers::pi * random.uniform()};
  }
}

Eigen::Vector2d Displacement::at(const Eigen::Vector2d& p) const {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Wave& wave : waves_) {
    const double phase = wave.direction.dot(p);
    sum += Eigen::Vector2d(std::cos(phase + wave.phase_x), std::cos(phase + wave.phase_y));
  }
  return amplitude_mm_ * sum;  // a cosine's mean square is 1/2, along x and y: together kWaves
}

void add_wrong_discs(double share, double radius_mm, std::span<const Eigen::Vector2d> view, Random& random,
                     PhantomSection& section) {
  constexpr std::uint32_t kCorners = 12;
  constexpr double kStep = 2 * std::numbers::pi / kCorners;
  const double disc_mm2 = kCorners / 2.0 * radius_mm * radius_mm * std::sin(kStep);
  const std::vector<Label> labels = labels_of(section);
  const double wanted_mm2 = share * std::abs(signed_area(view));
  if (labels.size() == 1 || wanted_mm2 == 0) return;
  const PhantomSection truth = section;
  // The last disc is drawn or not so that the mean area is the wanted one.
  const auto discs = static_cast<std::uint32_t>(wanted_mm2 / disc_mm2 + random.uniform());
  for (std::uint32_t disc = 0; disc < discs; ++disc) {
    const Eigen::Vector2d middle = random_point_in(view, random);
    const Label there = label_in(truth, middle);
    auto other = static_cast<std::size_t>(random.uniform() * static_cast<double>(labels.size() - 1));
    if (labels[other] >= there) ++other;
    section.loops.push_back(
        {static_cast<std::uint32_t>(section.points.size()), kCorners, labels[other], labels[other] == kOutside});
    for (std::uint32_t i = 0; i < kCorners; ++i)
      section.points.push_back(middle + radius_mm * Eigen::Vector2d(std::cos(i * kStep), std::sin(i * kStep)));
  }
}

}  // namespace sonoloft::device_sim
