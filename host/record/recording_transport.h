#pragma once
#include <chrono>
#include <cstddef>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "host/device/transport.h"
#include "host/record/recorder.h"

// device -> transport -> [RECORDING TRANSPORT] -> session
//                                 '-> Recorder -> file

namespace sonoloft::record {

/// Another transport, whose requests, replies and transfers are recorded on their way, from the beginning or while it
/// is in use. Whoever uses it sees no difference.
/// Threads: as those of a Transport; record() and end_recording() from any, at any moment.
class RecordingTransport final : public device::Transport, private device::TransferSink {
 public:
  /// @param recorder  null: nothing is recorded until record()
  explicit RecordingTransport(std::unique_ptr<device::Transport> transport, std::shared_ptr<Recorder> recorder = {})
      : transport_(std::move(transport)), recorder_(std::move(recorder)) {}

  /// All that comes from now on, after what a replay has to know of what came before: who the probe is, and the START
  /// of the run at hand. A recording that goes on ends here. Closing the recorder is its owner's affair.
  /// @cost that of copying some hundred bytes; waits for no disk but in ~Recorder, where nobody else has the one before
  void record(std::shared_ptr<Recorder> recorder);
  /// Nothing of what comes from now on; to be replayed up to here.
  void end_recording() { record(nullptr); }

  [[nodiscard]] Result<std::size_t> control(std::span<const std::byte> request, std::span<std::byte> reply,
                                            std::chrono::milliseconds timeout) override;
  [[nodiscard]] Result<void> start_stream(device::TransferSink& sink, std::size_t max_record) override;
  [[nodiscard]] Result<void> send_block(std::span<const std::byte> block, std::chrono::milliseconds timeout) override {
    return transport_->send_block(block, timeout);
  }
  void stop_stream() override;
  void restart_stream() override { transport_->restart_stream(); }
  void reset_stream() override { transport_->reset_stream(); }
  [[nodiscard]] Result<void> reopen() override { return transport_->reopen(); }

 private:
  struct Exchange {
    std::vector<std::byte> request, reply;
  };

  void on_transfer(std::span<const std::byte> transfer) override;
  void on_event(std::span<const std::byte> event) override;
  void on_gone() override;
  // With mutex_ held:
  void keep(std::span<const std::byte> request, std::span<const std::byte> reply);
  void write(const Exchange& kept);

  void open_stream();
  void end_stream(StreamMark mark);

  const std::unique_ptr<device::Transport> transport_;
  device::TransferSink* sink_ = nullptr;  ///< while a stream runs

  std::mutex mutex_;  ///< guards what follows; held while the recorder copies, never while the sink is called
  std::shared_ptr<Recorder> recorder_;
  bool streaming_ = false;
  Exchange info_, calibration_, start_;  ///< the last that went well; empty: none. start_: of this stream
};

}  // namespace sonoloft::record
