#include "core/tracking/pose_track.h"

#include <algorithm>

namespace sonoloft {

void PoseTrack::add(Time time, std::optional<Eigen::Isometry3d> pose) {
  if (!samples_.empty() && time <= samples_.back().time) return;
  samples_.push_back({time, std::move(pose)});
}

std::optional<Eigen::Isometry3d> PoseTrack::at(Time time) const {
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), time,
                                      [](const Sample& sample, Time t) { return sample.time < t; });
  if (after == samples_.end()) return std::nullopt;
  if (after->time == time) return after->pose;
  if (after == samples_.begin()) return std::nullopt;
  const Sample &a = *std::prev(after), &b = *after;
  if (!a.pose || !b.pose || b.time - a.time > longest_gap_) return std::nullopt;
  const double share = static_cast<double>((time - a.time).count()) / static_cast<double>((b.time - a.time).count());
  const Eigen::Quaterniond from(a.pose->linear()), to(b.pose->linear());
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = from.slerp(share, to).normalized().toRotationMatrix();
  pose.translation() = (1 - share) * a.pose->translation() + share * b.pose->translation();
  return pose;
}

std::optional<PoseTrack::Time> PoseTrack::newest() const {
  if (samples_.empty()) return std::nullopt;
  return samples_.back().time;
}

void PoseTrack::forget_before(Time time) {
  while (samples_.size() > 1 && samples_[1].time <= time) samples_.pop_front();
}

}  // namespace sonoloft
