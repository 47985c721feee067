#include "core/slice/parallel.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <thread>
#include <vector>

namespace sonoloft {

void parallel_for(std::size_t count, std::size_t grain, int threads,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  assert(threads >= 1 && grain >= 1);
  const std::size_t pieces = (count + grain - 1) / grain;
  std::atomic<std::size_t> next{0};
  auto work = [&] {
    for (std::size_t piece = next.fetch_add(1); piece < pieces; piece = next.fetch_add(1))
      body(piece * grain, std::min(count, (piece + 1) * grain));
  };
  std::vector<std::jthread> helpers;
  const std::size_t wanted = std::min(static_cast<std::size_t>(threads), pieces);
  for (std::size_t i = 1; i < wanted; ++i) helpers.emplace_back(work);
  work();
}

}  // namespace sonoloft
