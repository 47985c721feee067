#include <algorithm>
#include <cmath>
#include <limits>

#include "core/methods/equal_importance/charts.h"
#include "core/methods/stack/slice_stack.h"

namespace sonoloft {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Of the reach of the contours: places farther from the curve belong to no slice.
constexpr double kReach = 1.2;

/// A section on the curve.
struct Station {
  Vector3d middle, along;  ///< along: tangent of the curve, times the step to be taken
  Eigen::Isometry3d frame;

  [[nodiscard]] double side(const Vector3d& p) const { return frame.linear().col(2).dot(p - middle); }
};

class SpineChart final : public SliceChart {
 public:
  SpineChart(std::vector<Station> stations, double reach_mm) : stations_(std::move(stations)), reach_mm_(reach_mm) {}

  [[nodiscard]] std::optional<ChartPlace> locate(const Vector3d& p) const override {
    std::optional<ChartPlace> nearest;
    for (std::size_t i = 0; i + 1 < stations_.size(); ++i) {
      const bool first = i == 0, last = i + 2 == stations_.size();
      const double beyond = stations_[i].side(p), before = -stations_[i + 1].side(p);
      if ((beyond < 0 && !first) || (before <= 0 && !last) || beyond + before <= 0) continue;
      const ChartPlace place = between(i, std::clamp(beyond / (beyond + before), 0.0, 1.0), p, beyond, before);
      if (place.at.norm() > reach_mm_ || (nearest && place.at.norm() >= nearest->at.norm())) continue;
      nearest = place;
      nearest->to_end_mm = std::min(first ? beyond : kNone, last ? before : kNone);
    }
    return nearest;
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  [[nodiscard]] ChartPlace between(std::size_t i, double t, const Vector3d& p, double beyond, double before) const {
    const Station &a = stations_[i], &b = stations_[i + 1];
    const double step = (b.middle - a.middle).norm(), u = 1 - t;
    const Vector3d middle =
        u * u * (1 + 2 * t) * a.middle + t * t * (1 + 2 * u) * b.middle + step * t * u * (u * a.along - t * b.along);
    const Eigen::Quaterniond turn = Eigen::Quaterniond(a.frame.linear()).slerp(t, Eigen::Quaterniond(b.frame.linear()));
    return {i, t, (turn.conjugate() * (p - middle)).head<2>(), beyond + before, 0};
  }

  std::vector<Station> stations_;
  double reach_mm_;
};

Vector3d middle_of(const TrackedSlice& slice) {
  Eigen::AlignedBox2d box;
  for (const Vector2d& p : slice.points) box.extend(p);
  return slice.image_to_reference * Vector3d(box.center().x(), box.center().y(), 0);
}

/// Frames on the curve: the first slice's, turned from slice to slice no more than their normals are.
std::vector<Station> stations_of(std::span<const TrackedSlice> slices) {
  std::vector<Station> stations;
  for (const TrackedSlice& s : slices) stations.push_back({middle_of(s), Vector3d::Zero(), s.image_to_reference});
  for (std::size_t i = 0; i < stations.size(); ++i) {
    Station& s = stations[i];
    const Vector3d back = s.middle - stations[i == 0 ? 0 : i - 1].middle,
                   ahead = stations[std::min(i + 1, stations.size() - 1)].middle - s.middle;
    Vector3d normal = s.frame.linear().col(2);
    if (normal.dot(back + ahead) < 0) normal = -normal;
    const Eigen::Matrix3d before = i == 0 ? s.frame.linear() : stations[i - 1].frame.linear();
    s.frame.linear() = Eigen::Quaterniond::FromTwoVectors(before.col(2), normal).toRotationMatrix() * before;
    s.frame.translation() = s.middle;
    const bool inner = i > 0 && i + 1 < stations.size();
    s.along =
        inner ? Vector3d(back / back.norm() * ahead.norm() + ahead / ahead.norm() * back.norm()).normalized() : normal;
  }
  return stations;
}

}  // namespace

Result<ChartedSlices> chart_spine(std::span<const TrackedSlice> slices, const std::string& method) {
  const auto not_along = [&](std::size_t i, const std::string& what) {
    return fail(ErrorCode::invalid_argument,
                method +
                    " takes slices that are parallel, rotated about an axis within the object, or one behind the other "
                    "along a curve; slice " +
                    std::to_string(i + 1) + what +
                    ": reconstruct without --method, which takes slices of any direction");
  };
  for (std::size_t i = 0; i < slices.size(); ++i)
    if (slices[i].points.empty()) return not_along(i, " is empty");
  ChartedSlices charted;
  charted.frame_to_reference.translation() = middle_of(slices[0]);
  std::vector<Station> stations = stations_of(slices);
  for (Station& s : stations) {
    s.middle -= charted.frame_to_reference.translation();
    s.frame.pretranslate(-charted.frame_to_reference.translation());
  }
  double reach_mm = 0;
  for (std::size_t i = 0; i < slices.size(); ++i) {
    auto section = section_in(charted.frame_to_reference * stations[i].frame, slices[i], i + 1, method);
    if (!section) return tl::unexpected<Error>(section.error());
    section->image_to_reference = stations[i].frame;
    for (const Vector2d& p : section->points) {
      const Vector3d lifted = section->image_to_reference * Vector3d(p.x(), p.y(), 0);
      if ((i > 0 && stations[i - 1].side(lifted) <= 0) || (i + 1 < slices.size() && stations[i + 1].side(lifted) >= 0))
        return not_along(i, " reaches through the plane of a neighbour");
      reach_mm = std::max(reach_mm, p.norm());
    }
    charted.sections.push_back(std::move(*section));
  }
  summarize(charted);
  for (std::size_t i = 0; i + 1 < stations.size(); ++i)
    charted.steps.push_back((stations[i + 1].middle - stations[i].middle).norm());
  charted.chart = std::make_unique<SpineChart>(std::move(stations), kReach * reach_mm);
  return charted;
}

}  // namespace sonoloft
