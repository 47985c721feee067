#pragma once
#include <cstdint>
#include <string>
#include <tl/expected.hpp>

namespace sonoloft {

/// Why outside input (wire, file, option, device) was not accepted. Our own mistakes are asserts, not errors.
enum class ErrorCode : std::uint16_t {
  invalid_argument = 1,  ///< an option or argument is outside of its range
  file_not_found,
  io_failed,           ///< reading or writing failed half-way
  unsupported_format,  ///< not a file of a kind that we read
  parse_failed,        ///< a file of the right kind that breaks its own rules
  empty_input,         ///< nothing to reconstruct
  non_finite,          ///< NaN or infinity where a number is needed
  non_planar,          ///< the vertices of a slice do not lie in its plane
  bad_contour,         ///< a contour that no repair makes sense of
  too_large,           ///< over a stated limit
  not_rigid,           ///< a pose that is not a rotation and a translation
  outside_box,         ///< the slice does not reach the box of the scan
  cell_limit,          ///< the complex may not grow further
  device_not_found,
  transport_closed,   ///< the device went away
  timed_out,          ///< no answer within the stated time
  protocol_mismatch,  ///< the device speaks another version
  wrong_state,        ///< the call does not fit the state (start while running, ...)
  refused_by_device,  ///< the device answered with an error status
  no_opencl_device,
  opencl_failed,
  not_available,  ///< an optional part is not installed or not built in
};

struct Error {
  ErrorCode code;
  std::string message;  ///< one line that names the cause and the remedy
};

template <class T>
using Result = tl::expected<T, Error>;

[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

/// The name of a code as written in docs/errors.md, e.g. "non_planar". Never fails.
[[nodiscard]] const char* name(ErrorCode code);

}  // namespace sonoloft
