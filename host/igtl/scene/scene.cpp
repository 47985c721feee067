#include "host/igtl/scene/scene.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "host/igtl/wire/message_bodies.h"

namespace sonoloft::igtl {
namespace {

constexpr const char* kPoseName = "ImageToReference";

using std::chrono::steady_clock;
using std::chrono::system_clock;

system_clock::time_point wall_clock(steady_clock::time_point time) {
  const auto ago = std::chrono::duration_cast<system_clock::duration>(steady_clock::now() - time);
  return system_clock::now() - ago;
}

}  // namespace

void Device::show(Message message) {
  message_ = std::move(message);
  frames_ = {};
  ++revision_;
}

std::shared_ptr<const Bytes> Device::frame(int version) const {
  auto& made = frames_[version >= 2 ? 1 : 0];
  if (!made) made = std::make_shared<const Bytes>(framed(message_, version));
  return made;
}

void Scene::show(const MeshUpdate& update) {
  const auto surfaces = label_surfaces(update.mesh.indexed());
  for (const LabelSurface& surface : surfaces) show(surface);
  for (const auto& last : last_points_) {
    const bool there =
        std::any_of(surfaces.begin(), surfaces.end(), [&](const auto& s) { return s.label == last.first; });
    if (!there) show(LabelSurface{last.first, {last.second}, {}});
  }
  said_ = std::to_string(update.revision) + " slices, " + std::to_string(surfaces.size()) + " labels";
}

void Scene::show(const LabelSurface& surface) {
  last_points_[surface.label] = surface.points.front();
  Device& device = surfaces_[surface.label];
  Bytes body = polydata_body(surface);
  if (body == device.body()) return;
  device.show({"POLYDATA", names_.of(surface.label), system_clock::now(), std::move(body)});
}

void Scene::show(const device::DeliveredSlice& slice) {
  if (slice.pose_status != device::PoseStatus::ok) return;
  static const Eigen::Isometry3d kLpsToRas{Eigen::Vector3d(-1, -1, 1).asDiagonal()};
  const Eigen::Isometry3d to_ras = kLpsToRas * slice.slice.image_to_reference;
  const auto time = wall_clock(slice.host_time ? slice.host_time->time : slice.arrival);
  transform_.show({"TRANSFORM", kPoseName, time, transform_body(to_ras)});
  tdata_.show({"TDATA", kPoseName, time, tdata_body(kPoseName, to_ras)});
}

}  // namespace sonoloft::igtl
