#include <doctest/doctest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "tests/support/wire/firmware_bench.h"

namespace {
std::atomic<long> allocations{0};

void* counted(std::size_t size) {
  ++allocations;
  void* block = std::malloc(size);
  if (block == nullptr) std::abort();
  return block;
}
}  // namespace

void* operator new(std::size_t size) {
  return counted(size);
}
void* operator new[](std::size_t size) {
  return counted(size);
}
void operator delete(void* block) noexcept {
  std::free(block);
}
void operator delete[](void* block) noexcept {
  std::free(block);
}
void operator delete(void* block, std::size_t) noexcept {
  std::free(block);
}
void operator delete[](void* block, std::size_t) noexcept {
  std::free(block);
}

using namespace sonoloft::protocol;
using namespace sonoloft::test;

TEST_CASE("no heap: requests, acquisition, sending and accepting never allocate") {
  FirmwareBench bench;
  auto slice = make_wire_slice(1, 20, 100);
  const auto& view = slice.view();
  auto masked = make_masked_slice(1);
  const auto& mask = masked.view();
  std::array<std::byte, kEventLen> event;
  Acceptor acceptor(test_agreement());
  AcceptedSlice accepted;
  CalibrationMessage calibration = FirmwareBench::config().calibration;

  const long before = allocations;
  bool all_well = true;
  for (int round = 0; round < 50; ++round) {
    all_well &= bench.ask<InfoReply>(Command::get_info).has_value();
    all_well &= bench.tell(Command::set_calibration, bytes_of(calibration)) == Status::ok;
    all_well &= bench.start() == Status::ok;
    for (int i = 0; i < 6; ++i) bench.firmware.acquire(view, bench.now_ms * 1'000'000);
    bench.firmware.acquire(mask, bench.now_ms * 1'000'000);
    bench.firmware.button(1, true, bench.now_ms * 1'000'000);
    all_well &= bench.firmware.take_event(event) == kEventLen;
    for (int i = 0; i < 4; ++i) all_well &= acceptor.accept(bench.take(), accepted) == Reject::none;
    all_well &= bench.ask<StatsReply>(Command::get_stats).has_value();
    all_well &= bench.tell(Command::stop) == Status::ok;
  }
  const long during = allocations - before;
  CHECK(all_well);
  CHECK(during == 0);
  CHECK(before > 0);  // the counter counts
  MESSAGE("200 records, " << during << " allocations");
}
