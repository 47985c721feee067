#pragma once
// What all programs here have in common: each prints its figures as lines of JSON to the output, for the report, and in
// words to the error stream, for people.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/slice/result.h"

namespace sonoloft::bench {

using Clock = std::chrono::steady_clock;

inline double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// The value below which the share q of the values lies. @pre not empty
inline double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
}

inline double median(std::vector<double> values) {
  return quantile(std::move(values), 0.5);
}

/// The most memory that this process ever had resident.
inline double peak_memory_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

inline void emit(const nlohmann::json& figures, const std::string& words) {
  std::fprintf(stderr, "%s\n", words.c_str());
  std::printf("%s\n", figures.dump().c_str());
  std::fflush(stdout);
}

/// There is nothing to measure then.
[[noreturn]] inline void stop(const Error& error) {
  std::fprintf(stderr, "%s\n", error.message.c_str());
  std::exit(1);
}

template <class T>
T or_exit(Result<T> result) {
  if (!result) stop(result.error());
  return std::move(*result);
}

}  // namespace sonoloft::bench
