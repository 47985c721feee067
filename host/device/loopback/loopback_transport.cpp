#include "host/device/loopback/loopback_transport.h"

#include <array>
#include <cassert>
#include <cstdint>
#include <vector>

#include "protocol/event.h"
#include "protocol/record.h"

namespace sonoloft::device {

using protocol::PortStatus;

namespace {

constexpr std::uint32_t kReadTimeoutMs = 1000;

// Transfers must start on 64 bytes.
class TransferBuffer {
 public:
  explicit TransferBuffer(std::size_t size) : blocks_((size + sizeof(Block) - 1) / sizeof(Block)) {}
  std::span<std::byte> bytes() { return std::as_writable_bytes(std::span(blocks_)); }

 private:
  struct alignas(protocol::kRecordAlign) Block {
    std::byte bytes[protocol::kRecordAlign];
  };
  std::vector<Block> blocks_;
};

tl::unexpected<Error> gone() {
  return fail(ErrorCode::transport_closed, "the device was unplugged: plug it in and open it again");
}

tl::unexpected<Error> silent() {
  return fail(ErrorCode::timed_out, "the device did not answer: check the cable, then open it again");
}

}  // namespace

LoopbackTransport::~LoopbackTransport() {
  assert(!event_thread_.joinable());
}

Result<std::size_t> LoopbackTransport::control(std::span<const std::byte> request, std::span<std::byte> reply,
                                               std::chrono::milliseconds) {
  const auto done = port_.control(request, reply);
  if (done.status == PortStatus::ok) return done.size;
  if (done.status == PortStatus::gone) return gone();
  return silent();
}

Result<void> LoopbackTransport::send_block(std::span<const std::byte> block, std::chrono::milliseconds) {
  const auto done = port_.write_block(block);
  if (done.status == PortStatus::ok) return {};
  if (done.status == PortStatus::gone) return gone();
  return silent();
}

Result<void> LoopbackTransport::start_stream(TransferSink& sink, std::size_t max_record) {
  assert(!event_thread_.joinable());
  port_.allow_reads();
  TransferBuffer stale(max_record);
  port_.clear_halt();
  auto status = PortStatus::ok;
  while (status == PortStatus::ok) status = port_.read(stale.bytes(), 0).status;
  if (status == PortStatus::gone) return gone();
  event_thread_ = std::jthread([this, &sink, max_record] { pass_on(sink, max_record); });
  device_events_thread_ = std::jthread([this, &sink] { pass_on_events(sink); });
  return {};
}

void LoopbackTransport::stop_stream() {
  if (!event_thread_.joinable()) return;
  port_.cancel_reads();
  event_thread_.join();
  device_events_thread_.join();
}

void LoopbackTransport::pass_on_events(TransferSink& sink) {
  std::array<std::byte, protocol::kEventLen> event;
  while (true) {
    const auto done = port_.read_event(event, kReadTimeoutMs);
    if (done.status == PortStatus::cancelled || done.status == PortStatus::gone) return;
    if (done.status == PortStatus::ok) sink.on_event(std::span(event).first(done.size));
  }
}

void LoopbackTransport::pass_on(TransferSink& sink, std::size_t max_record) {
  TransferBuffer buffer(max_record);
  while (true) {
    const auto done = port_.read(buffer.bytes(), kReadTimeoutMs);
    switch (done.status) {
      case PortStatus::ok:
        sink.on_transfer(buffer.bytes().first(done.size));
        break;
      case PortStatus::timed_out:
        break;
      case PortStatus::halted:
        port_.clear_halt();
        break;
      case PortStatus::cancelled:
        return;
      case PortStatus::gone:
        sink.on_gone();
        return;
    }
  }
}

}  // namespace sonoloft::device
