#pragma once
#include <chrono>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include "host/device/transport.h"
#include "host/record/recorder.h"

// device -> transport -> [RECORDING TRANSPORT] -> session
//                                 '-> Recorder -> file

namespace sonoloft::record {

/// Another transport, whose requests, replies and transfers are recorded on their way. Whoever uses it sees no
/// difference.
class RecordingTransport final : public device::Transport, private device::TransferSink {
 public:
  RecordingTransport(std::unique_ptr<device::Transport> transport, std::shared_ptr<Recorder> recorder)
      : transport_(std::move(transport)), recorder_(std::move(recorder)) {}

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
  void on_transfer(std::span<const std::byte> transfer) override;
  void on_event(std::span<const std::byte> event) override;
  void on_gone() override;

  const std::unique_ptr<device::Transport> transport_;
  const std::shared_ptr<Recorder> recorder_;
  device::TransferSink* sink_ = nullptr;  ///< while a stream runs
};

}  // namespace sonoloft::record
