#pragma once
#include <span>
#include <string>
#include <vector>

namespace sonoloft {

/// Compiled programs kept between runs in $XDG_CACHE_HOME/sonoloft, else ~/.cache/sonoloft. `key` is all that the
/// program depends on (device, driver, options, source). Nothing here is an error: without a cache, programs are built
/// again. Files that are cut short, damaged or of another key read as empty. Threads and processes: any.
[[nodiscard]] std::vector<unsigned char> read_cached_program(const std::string& key);
void write_cached_program(const std::string& key, std::span<const unsigned char> program);

}  // namespace sonoloft
