#pragma once
#include <cstdint>

namespace sonoloft {

/// Where the field is evaluated.
enum class DeviceChoice : std::uint8_t {
  automatic,  ///< OpenCL where there is a working device, else the CPU twin; which one is logged
  opencl,
  cpu,
};

}  // namespace sonoloft
