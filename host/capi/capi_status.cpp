#include "host/capi/capi_status.h"

#include <cstdio>

#include "sonoloft/version.h"

namespace sonoloft::capi {

static_assert(SONOLOFT_INVALID_ARGUMENT == static_cast<int>(ErrorCode::invalid_argument));
static_assert(SONOLOFT_NON_FINITE == static_cast<int>(ErrorCode::non_finite));
static_assert(SONOLOFT_DEVICE_NOT_FOUND == static_cast<int>(ErrorCode::device_not_found));
static_assert(SONOLOFT_NOT_AVAILABLE == static_cast<int>(ErrorCode::not_available));

sonoloft_status report(sonoloft_status status, const char* message, sonoloft_error* error) noexcept {
  if (error) {
    error->status = status;
    std::snprintf(error->message, sizeof error->message, "%s", message);
  }
  return status;
}

}  // namespace sonoloft::capi

const char* sonoloft_status_name(sonoloft_status status) {
  if (status == SONOLOFT_OK) return "ok";
  if (status == SONOLOFT_OUT_OF_MEMORY) return "out_of_memory";
  return sonoloft::name(static_cast<sonoloft::ErrorCode>(status));
}

const char* sonoloft_version(void) {
  return SONOLOFT_VERSION;
}
