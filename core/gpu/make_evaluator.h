#pragma once
#include <functional>
#include <memory>
#include <string>

#include "core/field/device_choice.h"
#include "core/field/field_evaluator.h"
#include "core/slice/result.h"

namespace sonoloft {

/// The evaluator of a run; one run stays with one, since different devices round differently.
/// `automatic` is OpenCL on a graphics device or an accelerator, else the CPU twin: on a processor that is faster than
/// OpenCL (docs/pipeline/4-field.md has the figures).
/// @param threads  CPU threads to use, also of an OpenCL device that is the CPU
/// @param log      called (here and now) with one line on what was chosen and, for `automatic`, why not OpenCL; may be
/// empty
/// @error invalid_argument (threads < 1); for `opencl`: no_opencl_device, opencl_failed
/// @cost  compiles the kernel on first use, about a second; later from caches on disk
[[nodiscard]] Result<std::unique_ptr<FieldEvaluator>> make_evaluator(
    DeviceChoice choice, int threads, const std::function<void(const std::string& line)>& log);

}  // namespace sonoloft
