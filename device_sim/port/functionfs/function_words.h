#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "device_sim/port/usb/descriptors.h"

// What a function says of itself when it opens its functionfs: linux/usb/functionfs.h. And what the gadget around it,
// in configfs, has to say to be the device.

namespace sonoloft::device_sim::functionfs {

/// The interface and its endpoints, at full and at high speed, as the device model has them. The controller may give
/// the endpoints other addresses.
[[nodiscard]] std::vector<std::byte> function_descriptors(const usb::Descriptors& descriptors);

/// None, which must be said.
[[nodiscard]] std::vector<std::byte> function_strings();

/// A file in the gadget's folder, and what belongs in there.
struct Attribute {
  std::string name, value;
};
[[nodiscard]] std::vector<Attribute> gadget_attributes(const usb::Descriptors& descriptors);

}  // namespace sonoloft::device_sim::functionfs
