#pragma once
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "core/slice/result.h"
#include "host/device/calibration.h"
#include "host/device/clock/clock_keeper.h"
#include "host/device/delivered_slice.h"
#include "host/device/delivery_queue.h"
#include "host/device/ledger.h"
#include "host/device/requester.h"
#include "host/device/statistics.h"
#include "host/device/transport.h"
#include "protocol/accept.h"
#include "protocol/command.h"
#include "protocol/event.h"

namespace sonoloft::device {

/// One run of a session, from START to closed books. Three threads take part: the transport's event thread accepts
/// transfers and converts slices; the dispatcher calls back; the keeper sends the signs of life, notices the end of the
/// device or of its data, and takes the run down.
class Run final : private TransferSink {
 public:
  struct Plan {
    protocol::Agreement agreement;
    Calibration calibration;
    std::size_t queue_capacity = 1;
    protocol::StartRequest start;
    Callbacks callbacks;
  };

  /// @pre `transport` and `requester` outlive the run; plan.queue_capacity >= 1
  Run(Transport& transport, Requester& requester, Plan plan);
  /// @pre begin() failed or join() returned
  ~Run();

  /// Opens the stream and sends START. @error those of Transport::start_stream() and Requester::tell(): nothing runs
  [[nodiscard]] Result<void> begin();
  /// From any thread. Callbacks end with the one that runs now; the keeper takes everything down.
  void request_stop();
  /// Waits until everything is down. @pre begin() succeeded, request_stop() was called; not on the dispatcher
  void join();

  [[nodiscard]] bool on_dispatcher() const;
  [[nodiscard]] bool stopping() const;
  /// The device went away, or stood still and nothing helped.
  [[nodiscard]] bool lost() const;
  [[nodiscard]] Statistics statistics() const;

 private:
  void on_transfer(std::span<const std::byte> transfer) override;
  void on_event(std::span<const std::byte> bytes) override;
  void on_gone() override;
  void report_button(const protocol::EventMessage& event);
  void count_reject(protocol::Reject reason);
  void enqueue(std::shared_ptr<const DeliveredSlice> slice, std::uint32_t device_dropped_total);

  void dispatch();
  void call(const DeliveryQueue::Item& item);
  void call_event(const Event& event);

  void keep();
  bool wait_for_work();
  void beat();
  void synchronise();
  void look_for_fault(const protocol::HeartbeatReply& beat);
  void look_for_end(const protocol::HeartbeatReply& beat);
  void look_for_stall(const Result<protocol::HeartbeatReply>& beat);
  void report(Event event);
  void take_down();

  Transport& transport_;
  Requester& requester_;
  const Plan plan_;
  protocol::Acceptor acceptor_;  ///< the event thread's

  ClockKeeper clock_;  ///< after begin(), its bursts are the keeper's

  // The keeper's.
  std::chrono::steady_clock::time_point next_beat_{};
  bool fault_told_ = false, end_told_ = false;
  std::uint64_t seen_at_last_beat_ = 0;
  int quiet_beats_ = 0;
  std::uint64_t seen_at_last_look_ = 0;
  std::chrono::steady_clock::time_point next_cure_{};
  int cures_ = 0;  ///< tried since the stream stands still

  mutable std::mutex mutex_;  ///< guards what follows; never held during a callback or a request
  std::condition_variable to_dispatcher_, to_keeper_, room_;
  DeliveryQueue queue_;
  Books books_;
  std::array<std::uint64_t, protocol::kRejectCount> rejected_{};
  std::uint32_t next_event_ = 0;  ///< its number
  std::uint64_t events_lost_ = 0;
  bool beat_early_ = false;  ///< the device has news of itself
  bool stopping_ = false, gone_ = false;
  bool stalled_ = false;  ///< gone_ in effect, but it may still answer

  std::jthread dispatcher_, keeper_;
};

}  // namespace sonoloft::device
