// A transport whose functions are those of C: a probe in this process behind them.
#include <cstring>
#include <memory>
#include <vector>

#include "host/simulated/simulated_probe.h"
#include "tests/unit/capi/capi_scan.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

/// Hands transfers on as a driver would, from a buffer of its own.
class Driver final : private device::TransferSink {
 public:
  explicit Driver(std::size_t misalignment)
      : misalignment_(misalignment), device_(*open_simulated_probe({.slices = 6, .rate_hz = 0})) {}

  sonoloft_transport functions() {
    return {sizeof(sonoloft_transport), this, &control, &start_stream, &stop_stream, &close, &send_block};
  }
  [[nodiscard]] int closed() const { return closed_; }
  [[nodiscard]] int transfers() const { return transfers_; }
  [[nodiscard]] int events() const { return events_; }

 private:
  static Driver& self(void* user) { return *static_cast<Driver*>(user); }
  static sonoloft_status control(void* user, const void* request, std::size_t request_length, void* reply,
                                 std::size_t room, std::size_t* reply_length, std::uint32_t timeout_ms) {
    const auto done =
        self(user).device_->control({static_cast<const std::byte*>(request), request_length},
                                    {static_cast<std::byte*>(reply), room}, std::chrono::milliseconds(timeout_ms));
    if (!done) return static_cast<sonoloft_status>(done.error().code);
    *reply_length = *done;
    return SONOLOFT_OK;
  }
  static sonoloft_status start_stream(void* user, sonoloft_sink* sink, std::size_t max_record) {
    self(user).sink_ = sink;
    self(user).buffer_.resize(max_record + 2 * kAlignment);
    return self(user).device_->start_stream(self(user), max_record) ? SONOLOFT_OK : SONOLOFT_IO_FAILED;
  }
  static void stop_stream(void* user) { self(user).device_->stop_stream(); }
  static void close(void* user) { ++self(user).closed_; }
  static sonoloft_status send_block(void* user, const void* bytes, std::size_t length, std::uint32_t timeout_ms) {
    const auto sent = self(user).device_->send_block({static_cast<const std::byte*>(bytes), length},
                                                     std::chrono::milliseconds(timeout_ms));
    return sent ? SONOLOFT_OK : static_cast<sonoloft_status>(sent.error().code);
  }

  void on_transfer(std::span<const std::byte> transfer) override {
    ++transfers_;
    const auto start = reinterpret_cast<std::uintptr_t>(buffer_.data());
    std::byte* const to = buffer_.data() + (kAlignment - start % kAlignment) + misalignment_;
    std::memcpy(to, transfer.data(), transfer.size());
    sonoloft_sink_transfer(sink_, to, transfer.size());
  }
  void on_event(std::span<const std::byte> event) override {
    ++events_;
    sonoloft_sink_event(sink_, event.data(), event.size());
  }
  void on_gone() override { sonoloft_sink_gone(sink_); }

  static constexpr std::size_t kAlignment = 64;
  const std::size_t misalignment_;
  std::unique_ptr<device::Transport> device_;
  sonoloft_sink* sink_ = nullptr;
  std::vector<std::byte> buffer_;
  std::atomic<int> closed_ = 0, transfers_ = 0, events_ = 0;
};

}  // namespace

TEST_CASE("capi transport: a scan through one that is written in C gets every slice, however its buffers lie") {
  for (const std::size_t misalignment : {0u, 1u, 8u}) {
    Driver driver(misalignment);
    const sonoloft_transport functions = driver.functions();
    sonoloft_probe* probe = nullptr;
    REQUIRE(sonoloft_open_transport(&functions, &probe, nullptr) == SONOLOFT_OK);
    const auto options = scan_options();
    sonoloft_scan* scan = nullptr;
    sonoloft_error error{};
    REQUIRE_MESSAGE(sonoloft_scan_open(probe, &options, &scan, &error) == SONOLOFT_OK, error.message);
    Follower follower;
    follower.start(scan);
    REQUIRE(follower.wait_for(SONOLOFT_END_OF_DATA));
    sonoloft_scan_stop(scan);
    CHECK(statistics_of(scan).sent_on == 6);
    CHECK(statistics_of(scan).closed == 1);
    CHECK(driver.transfers() == 6);
    CHECK(driver.closed() == 0);
    sonoloft_scan_close(scan);
    CHECK(driver.closed() == 1);
  }
}

TEST_CASE("capi transport: one that fails, lies about a reply or lacks a function is an error") {
  struct Bad {
    sonoloft_status answer;
    std::size_t length;
  };
  sonoloft_transport functions{};
  functions.size = sizeof functions;
  sonoloft_probe* probe = nullptr;
  CHECK(sonoloft_open_transport(&functions, &probe, nullptr) == SONOLOFT_INVALID_ARGUMENT);
  functions.start_stream = [](void*, sonoloft_sink*, std::size_t) { return SONOLOFT_OK; };
  functions.stop_stream = [](void*) {};
  functions.control = [](void* user, const void*, std::size_t, void*, std::size_t, std::size_t* length, std::uint32_t) {
    *length = static_cast<Bad*>(user)->length;
    return static_cast<Bad*>(user)->answer;
  };
  for (Bad bad : {Bad{SONOLOFT_TIMED_OUT, 0}, Bad{SONOLOFT_TRANSPORT_CLOSED, 0}, Bad{SONOLOFT_OK, 1u << 20}}) {
    functions.user = &bad;
    REQUIRE(sonoloft_open_transport(&functions, &probe, nullptr) == SONOLOFT_OK);
    const auto options = scan_options();
    sonoloft_scan* scan = nullptr;
    const auto expected = bad.answer == SONOLOFT_OK ? SONOLOFT_IO_FAILED : bad.answer;
    CHECK(sonoloft_scan_open(probe, &options, &scan, nullptr) == expected);
  }
}
