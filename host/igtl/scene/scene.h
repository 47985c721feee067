#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "host/device/delivered_slice.h"
#include "host/igtl/scene/device_names.h"
#include "host/igtl/scene/label_surfaces.h"
#include "host/igtl/wire/message.h"
#include "host/scan/mesh_update.h"

// MeshUpdate, DeliveredSlice -> [SCENE: each device's newest message] -> clients

namespace sonoloft::igtl {

/// The newest message of one device: one label's surface, the pose.
class Device {
 public:
  /// Shows this from now on.
  void show(Message message);

  [[nodiscard]] std::uint64_t revision() const { return revision_; }  ///< 0: nothing was shown yet
  [[nodiscard]] const std::string& name() const { return message_.device; }
  [[nodiscard]] const Bytes& body() const { return message_.body; }
  /// As clients of this version get it; made once. @pre something was shown
  [[nodiscard]] std::shared_ptr<const Bytes> frame(int version) const;

 private:
  Message message_;
  std::uint64_t revision_ = 0;
  mutable std::array<std::shared_ptr<const Bytes>, 2> frames_;  ///< of versions 1 and 2
};

/// What there is to see now. Threads: one at a time.
class Scene {
 public:
  explicit Scene(LabelTable labels) : names_(std::move(labels)) {}

  /// A surface each label. One that was there and is there no more becomes a point without triangles: receivers keep
  /// what they have until something comes in its place.
  /// A surface that did not change is no news. @cost O(mesh)
  void show(const MeshUpdate& update);
  /// Its pose; nothing where that is not ok.
  void show(const device::DeliveredSlice& slice);

  [[nodiscard]] const std::map<Label, Device>& surfaces() const { return surfaces_; }
  [[nodiscard]] const Device& transform() const { return transform_; }
  [[nodiscard]] const Device& tdata() const { return tdata_; }
  [[nodiscard]] const std::string& said() const { return said_; }  ///< for STATUS

 private:
  void show(const LabelSurface& surface);

  DeviceNames names_;
  std::map<Label, Device> surfaces_;
  std::map<Label, std::array<float, 3>> last_points_;  ///< of each surface, any
  Device transform_, tdata_;
  std::string said_ = "no mesh yet";
};

}  // namespace sonoloft::igtl
