#pragma once
// C++ errors and structs that grow -> [STATUS] -> C
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <new>
#include <string>

#include "core/slice/result.h"
#include "host/capi/sonoloft.h"

namespace sonoloft::capi {

/// Fills `error` where there is one. @return its status
sonoloft_status report(sonoloft_status status, const char* message, sonoloft_error* error) noexcept;

/// Runs what returns Result<void>: no exception leaves it.
template <class Call>
sonoloft_status guarded(sonoloft_error* error, Call call) noexcept {
  try {
    const Result<void> done = call();
    if (done) return SONOLOFT_OK;
    return report(static_cast<sonoloft_status>(done.error().code), done.error().message.c_str(), error);
  } catch (const std::bad_alloc&) {
    return report(SONOLOFT_OUT_OF_MEMORY, "out of memory", error);
  } catch (const std::exception& e) {
    return report(SONOLOFT_NOT_AVAILABLE, e.what(), error);
  }
}

/// @error invalid_argument: one of them is NULL
template <class... Pointers>
Result<void> need(Pointers... pointers) {
  if (((pointers != nullptr) && ...)) return {};
  return fail(ErrorCode::invalid_argument, "a NULL was given where an object is due");
}

/// A struct of the caller's, which may know fewer fields than we do, or more; what it does not know is 0.
/// @error invalid_argument (NULL, no size, fields that we do not know and that are not 0)
template <class T>
Result<T> read_sized(const T* given) {
  if (!given || given->size < sizeof(given->size))
    return fail(ErrorCode::invalid_argument, "a struct without its size was given: set `size` to sizeof of it");
  const auto* bytes = reinterpret_cast<const unsigned char*>(given);
  if (std::any_of(bytes + std::min(sizeof(T), given->size), bytes + given->size, [](auto b) { return b != 0; }))
    return fail(ErrorCode::invalid_argument, "a field of a newer sonoloft.h is set: update the library");
  T known{};
  std::memcpy(&known, given, std::min(sizeof(T), given->size));
  return known;
}

/// Writes as much of `value` as the caller's struct has room for.
/// @error invalid_argument (NULL, no size)
template <class T>
Result<void> write_sized(T value, T* out) {
  if (!out || out->size < sizeof(out->size))
    return fail(ErrorCode::invalid_argument, "a struct without its size was given: set `size` to sizeof of it");
  value.size = out->size;
  std::memcpy(out, &value, std::min(sizeof(T), out->size));
  return {};
}

}  // namespace sonoloft::capi
