#pragma once
#include <cstdint>

namespace sonoloft {

/// Where the field is evaluated.
enum class DeviceChoice : std::uint8_t {
  automatic,  ///< OpenCL on a working graphics device or accelerator, else the CPU twin; which one is logged
  opencl,     ///< on what there is, a processor too
  cpu,
};

}  // namespace sonoloft
