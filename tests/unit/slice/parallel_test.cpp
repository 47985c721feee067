#include "core/slice/parallel.h"

#include <doctest/doctest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "core/slice/scratch_pool.h"

using namespace sonoloft;

namespace {

/// How often each index of [0, count) was visited.
std::vector<int> visits(std::size_t count, std::size_t grain, int threads) {
  std::vector<int> seen(count, 0);
  parallel_for(count, grain, threads, [&](std::size_t first, std::size_t last) {
    CHECK(last - first <= grain);
    for (std::size_t i = first; i < last; ++i) ++seen[i];
  });
  return seen;
}

}  // namespace

TEST_CASE("parallel: every index is visited once, whatever the grain and the number of threads") {
  for (const std::size_t count : {0u, 1u, 7u, 1000u})
    for (const std::size_t grain : {1u, 3u, 64u, 5000u})
      for (const int threads : {1, 2, 5}) CHECK(visits(count, grain, threads) == std::vector<int>(count, 1));
}

TEST_CASE("parallel: no more threads work than were asked for, however many were before") {
  visits(100, 1, 8);
  std::atomic<int> working{0}, most{0};
  for (int round = 0; round < 200; ++round)
    parallel_for(50, 1, 3, [&](std::size_t, std::size_t) {
      const int now = ++working;
      for (int seen = most; seen < now && !most.compare_exchange_weak(seen, now);) {
      }
      --working;
    });
  MESSAGE("at most " << most << " of 3 threads at a time");
  CHECK(most <= 3);
}

TEST_CASE("parallel: calls from several threads and from within a call all come to their end") {
  std::vector<std::jthread> callers;
  std::atomic<std::size_t> sum{0};
  for (int caller = 0; caller < 4; ++caller)
    callers.emplace_back([&] {
      for (int round = 0; round < 50; ++round)
        parallel_for(16, 1, 3, [&](std::size_t first, std::size_t) {
          parallel_for(10, 2, 2, [&](std::size_t from, std::size_t to) { sum += first * (to - from); });
        });
    });
  callers.clear();
  CHECK(sum == 4u * 50u * 10u * (15u * 16u / 2u));
}

TEST_CASE("parallel: a scratch is one thread's at a time, and is used again") {
  struct Scratch {
    std::atomic<int> users{0};
    int uses = 0;
  };
  ScratchPool<Scratch> pool;
  std::atomic<int> shared{0};
  parallel_for(500, 1, 4, [&](std::size_t, std::size_t) {
    const auto scratch = pool.take();
    if (++scratch->users != 1) ++shared;
    ++scratch->uses;
    --scratch->users;
  });
  CHECK(shared == 0);
  const auto a = pool.take(), b = pool.take(), c = pool.take(), d = pool.take();
  CHECK(a->uses + b->uses + c->uses + d->uses == 500);  // no fifth one was made
}
