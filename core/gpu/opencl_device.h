#pragma once
#include <string>

#include "core/gpu/opencl.h"
#include "core/gpu/opencl_evaluator.h"
#include "core/slice/result.h"

namespace sonoloft {

/// A device with its context and two in-order queues, so that copies and kernels run side by side.
struct OpenClDevice {
  cl::Device device;
  cl::Context context;
  cl::CommandQueue copies, kernels;
  std::string name;
  bool is_processor = false;  ///< a CPU, possibly the part of it that `threads` allows
};

/// The first graphics device or accelerator with OpenCL 1.2 and a compiler, else the first processor.
/// @param threads  cores to use when the device is the processor
/// @error no_opencl_device, opencl_failed
[[nodiscard]] Result<OpenClDevice> open_opencl_device(int threads, DeviceKinds kinds);

/// Builds `source` for the device, or takes it from the cache in $XDG_CACHE_HOME/sonoloft (~/.cache/sonoloft), where it
/// is then kept; a cache that cannot be written is no error.
/// @error opencl_failed, with the first line of the compiler's complaint
[[nodiscard]] Result<cl::Program> build_program(const OpenClDevice& device, const std::string& source,
                                                const std::string& options);

}  // namespace sonoloft
