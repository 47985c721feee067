#pragma once
#include <memory>

#include "core/field/field_evaluator.h"
#include "core/slice/result.h"

namespace sonoloft {

/// How many points a work-item takes: 1 on graphics devices, a vector of 4, 8 or 16 on processors, whose compilers make
/// vectors of neighbouring work-items too seldom.
enum class KernelForm { by_device, scalar };

/// Which devices will do.
enum class DeviceKinds { all, no_processors };

/// The evaluator on the best OpenCL device: a graphics device or an accelerator before a processor. Returns only if the
/// device computes a cell of known values rightly.
/// @param threads  cores to use when the device is the processor
/// @error no_opencl_device, opencl_failed
/// @cost  compiles on first use, about a second; later from the caches on disk
[[nodiscard]] Result<std::unique_ptr<FieldEvaluator>> make_opencl_evaluator(int threads, KernelForm form,
                                                                            DeviceKinds kinds = DeviceKinds::all);

}  // namespace sonoloft
