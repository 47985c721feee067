#pragma once
#include <cstddef>
#include <functional>

namespace sonoloft {

/// Calls body(first, last) for pieces of [0, count) on up to `threads` threads, the calling one among them, and returns
/// when all are done. Which thread gets which piece is not fixed: bodies write only to what their indices own, so
/// results do not depend on the number of threads.
/// @pre threads >= 1, grain >= 1; body does not throw
void parallel_for(std::size_t count, std::size_t grain, int threads,
                  const std::function<void(std::size_t first, std::size_t last)>& body);

}  // namespace sonoloft
