#include "core/slice/result.h"

namespace sonoloft {

const char* name(ErrorCode code) {
  switch (code) {
    case ErrorCode::invalid_argument:
      return "invalid_argument";
    case ErrorCode::file_not_found:
      return "file_not_found";
    case ErrorCode::io_failed:
      return "io_failed";
    case ErrorCode::unsupported_format:
      return "unsupported_format";
    case ErrorCode::parse_failed:
      return "parse_failed";
    case ErrorCode::empty_input:
      return "empty_input";
    case ErrorCode::non_finite:
      return "non_finite";
    case ErrorCode::non_planar:
      return "non_planar";
    case ErrorCode::bad_contour:
      return "bad_contour";
    case ErrorCode::too_large:
      return "too_large";
    case ErrorCode::not_rigid:
      return "not_rigid";
    case ErrorCode::outside_box:
      return "outside_box";
    case ErrorCode::cell_limit:
      return "cell_limit";
    case ErrorCode::device_not_found:
      return "device_not_found";
    case ErrorCode::transport_closed:
      return "transport_closed";
    case ErrorCode::timed_out:
      return "timed_out";
    case ErrorCode::protocol_mismatch:
      return "protocol_mismatch";
    case ErrorCode::wrong_state:
      return "wrong_state";
    case ErrorCode::refused_by_device:
      return "refused_by_device";
    case ErrorCode::no_opencl_device:
      return "no_opencl_device";
    case ErrorCode::opencl_failed:
      return "opencl_failed";
    case ErrorCode::not_available:
      return "not_available";
  }
  return "unknown_error";  // a number that came over the wire or through the C ABI
}

}  // namespace sonoloft
