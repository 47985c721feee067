#pragma once
#include <thread>

#include "host/device/transport.h"
#include "protocol/port.h"

namespace sonoloft::device {

/// Reaches a device that lives in this process, through its port.
class LoopbackTransport final : public Transport {
 public:
  /// @pre `port` outlives the transport
  explicit LoopbackTransport(protocol::Port& port) : port_(port) {}
  ~LoopbackTransport() override;

  /// A reply comes at once or never: `timeout` is not needed.
  [[nodiscard]] Result<std::size_t> control(std::span<const std::byte> request, std::span<std::byte> reply,
                                            std::chrono::milliseconds timeout) override;
  [[nodiscard]] Result<void> send_block(std::span<const std::byte> block, std::chrono::milliseconds timeout) override;
  [[nodiscard]] Result<void> start_stream(TransferSink& sink, std::size_t max_record) override;
  void stop_stream() override;

 private:
  void pass_on(TransferSink& sink, std::size_t max_record);
  void pass_on_events(TransferSink& sink);

  protocol::Port& port_;
  std::jthread event_thread_, device_events_thread_;
};

}  // namespace sonoloft::device
