#pragma once
// The one door to the OpenCL bindings: version 1.2, errors as codes.
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#include <CL/opencl.hpp>
#include <string>

#include "core/slice/result.h"

namespace sonoloft {

/// An error of a call, `doing` said as "building the field kernel".
[[nodiscard]] inline tl::unexpected<Error> opencl_failure(cl_int code, const std::string& doing) {
  return fail(ErrorCode::opencl_failed, "OpenCL error " + std::to_string(code) + " while " + doing +
                                            "; update the driver or choose the device 'cpu'");
}

}  // namespace sonoloft
