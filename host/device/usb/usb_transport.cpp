#include "host/device/usb/usb_transport.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <fstream>
#include <thread>
#include <utility>

#include "host/device/usb/usb_error.h"
#include "host/device/usb/usb_handle.h"
#include "host/device/usb/usb_search.h"
#include "host/device/usb/usb_stream.h"
#include "protocol/command.h"
#include "protocol/usb.h"

namespace sonoloft::device {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxTransfers = 8, kMinTransfers = 2;  // 8: 130 ms of 60 slices a second
constexpr std::size_t kTransferStep = 1024;                  // whole packets at any speed
constexpr std::size_t kEventTransfers = 4;
constexpr std::chrono::milliseconds kDrainQuiet{10};
constexpr std::chrono::milliseconds kDrainPatience{1000};

std::size_t transfer_size(std::size_t max_record) {
  return (max_record + kTransferStep - 1) / kTransferStep * kTransferStep;
}

// How many transfers of this size the kernel lets one user have; all where it does not say.
Result<std::size_t> affordable_transfers(std::size_t size) {
  constexpr const char* kLimitFile = "/sys/module/usbcore/parameters/usbfs_memory_mb";
  std::size_t limit_mb = 0;
  if (!(std::ifstream(kLimitFile) >> limit_mb) || limit_mb == 0) return kMaxTransfers;  // 0: no limit
  const std::size_t count = (limit_mb << 20) / size;
  if (count >= kMinTransfers) return std::min(count, kMaxTransfers);
  return fail(ErrorCode::io_failed, "records of " + std::to_string(size) + " bytes need " +
                                        std::to_string((kMinTransfers * size >> 20) + 1) +
                                        " MB for USB transfers, the kernel allows " + std::to_string(limit_mb) +
                                        ": write a higher number into " + kLimitFile);
}

// Takes what comes and forgets it.
class Drain final : public TransferSink {
 public:
  void on_transfer(std::span<const std::byte>) override { ++received; }
  void on_gone() override { gone = true; }

  std::atomic<int> received = 0;
  std::atomic<bool> gone = false;
};

libusb_control_setup setup_of(std::uint8_t direction, std::uint8_t request, std::uint8_t interface, std::size_t len) {
  return {static_cast<std::uint8_t>(direction | LIBUSB_REQUEST_TYPE_VENDOR | LIBUSB_RECIPIENT_INTERFACE), request, 0,
          libusb_cpu_to_le16(interface), libusb_cpu_to_le16(static_cast<std::uint16_t>(len))};
}

}  // namespace

// Events come as transfers, too. That the device went away the stream tells.
class UsbTransport::EventSink final : public TransferSink {
 public:
  explicit EventSink(TransferSink& sink) : sink_(sink) {}
  void on_transfer(std::span<const std::byte> event) override { sink_.on_event(event); }
  void on_gone() override {}

 private:
  TransferSink& sink_;
};

Result<std::unique_ptr<UsbTransport>> UsbTransport::open(std::string_view serial) {
  auto found = find_probe(serial);
  if (!found) return tl::unexpected<Error>(found.error());
  if (auto claimed = found->handle->claim(); !claimed) return tl::unexpected<Error>(claimed.error());
  return std::unique_ptr<UsbTransport>(new UsbTransport(std::move(found->handle), std::move(found->serial)));
}

UsbTransport::UsbTransport(std::unique_ptr<UsbHandle> handle, std::string serial)
    : handle_(std::move(handle)), serial_(std::move(serial)) {}

UsbTransport::~UsbTransport() {
  assert(!stream_);
}

int UsbTransport::speed_mbit() const {
  return device::speed_mbit(libusb_get_device(handle_->libusb()));
}

Result<std::size_t> UsbTransport::control(std::span<const std::byte> request, std::span<std::byte> reply,
                                          std::chrono::milliseconds timeout) {
  if (gone_) return usb_error(LIBUSB_ERROR_NO_DEVICE, "USB probe " + serial_);
  auto size = exchange(request, reply, timeout);
  if (!size) note(size.error());
  return size;
}

Result<std::size_t> UsbTransport::exchange(std::span<const std::byte> request, std::span<std::byte> reply,
                                           std::chrono::milliseconds timeout) {
  using namespace protocol::usb;
  const auto deadline = Clock::now() + timeout;
  const std::uint8_t interface = handle_->interface().number;
  std::array<std::byte, protocol::kMaxRequestLen> sent;
  std::copy(request.begin(), request.end(), sent.begin());
  const auto out = handle_->control(setup_of(LIBUSB_ENDPOINT_OUT, kSendRequest, interface, request.size()),
                                    std::span(sent).first(request.size()), timeout);
  if (!out) return out;
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
  return handle_->control(setup_of(LIBUSB_ENDPOINT_IN, kReadReply, interface, protocol::kMaxRequestLen),
                          reply.first(protocol::kMaxRequestLen), std::max(left, std::chrono::milliseconds(1)));
}

void UsbTransport::note(const Error& error) {
  if (error.code == ErrorCode::transport_closed) gone_ = true;
}

Result<void> UsbTransport::start_stream(TransferSink& sink, std::size_t max_record) {
  assert(!stream_);
  if (gone_) return usb_error(LIBUSB_ERROR_NO_DEVICE, "USB probe " + serial_);
  const std::size_t size = transfer_size(max_record);
  const auto count = affordable_transfers(size);
  if (!count) return tl::unexpected<Error>(count.error());
  if (auto drained = drain(size); !drained) {
    note(drained.error());
    return drained;
  }
  const UsbInterface& interface = handle_->interface();
  if (interface.event_in != 0) {
    event_sink_ = std::make_unique<EventSink>(sink);
    auto events = std::make_unique<UsbStream>(handle_->libusb(), interface.event_in, LIBUSB_TRANSFER_TYPE_INTERRUPT,
                                              kEventTransfers, kTransferStep, *event_sink_);
    if (auto begun = begin(events_, std::move(events)); !begun) return begun;
  }
  return begin(stream_, std::make_unique<UsbStream>(handle_->libusb(), interface.stream_in, LIBUSB_TRANSFER_TYPE_BULK,
                                                    *count, size, sink));
}

Result<void> UsbTransport::begin(std::unique_ptr<UsbStream>& stream, std::unique_ptr<UsbStream> made) {
  stream = std::move(made);
  auto begun = stream->begin();
  if (!begun) {
    note(begun.error());
    stop_stream();
  }
  return begun;
}

Result<void> UsbTransport::drain(std::size_t transfer_size) {
  (void)libusb_clear_halt(handle_->libusb(), handle_->interface().stream_in);  // what fails here fails below
  Drain drained;
  auto draining = std::make_unique<UsbStream>(handle_->libusb(), handle_->interface().stream_in,
                                              LIBUSB_TRANSFER_TYPE_BULK, 1, transfer_size, drained);
  if (auto begun = begin(stream_, std::move(draining)); !begun) return begun;
  const auto deadline = Clock::now() + kDrainPatience;
  int before = -1;
  while (!drained.gone && before != drained.received && Clock::now() < deadline) {
    before = drained.received;
    std::this_thread::sleep_for(kDrainQuiet);
  }
  stop_stream();
  if (drained.gone || gone_) return usb_error(LIBUSB_ERROR_NO_DEVICE, "USB probe " + serial_);
  if (before == drained.received) return {};
  return fail(ErrorCode::io_failed, "USB probe " + serial_ + " sends though it was stopped: plug it in again");
}

void UsbTransport::stop_stream() {
  end(stream_);
  end(events_);
}

void UsbTransport::end(std::unique_ptr<UsbStream>& stream) {
  if (!stream) return;
  if (stream->end()) {
    stream.reset();
    return;
  }
  // The kernel still writes into its buffers, so they must never be freed.
  (void)stream.release();
  handle_->abandon();
  gone_ = true;
}

Result<void> UsbTransport::send_block(std::span<const std::byte> block, std::chrono::milliseconds timeout) {
  if (gone_) return usb_error(LIBUSB_ERROR_NO_DEVICE, "USB probe " + serial_);
  const std::uint8_t endpoint = handle_->interface().blob_out;
  if (endpoint == 0) return Transport::send_block(block, timeout);
  auto sent = handle_->write(endpoint, block, timeout);
  if (!sent) note(sent.error());
  return sent;
}

void UsbTransport::restart_stream() {
  if (stream_) stream_->restart();
}

void UsbTransport::reset_stream() {
  if (stream_) stream_->reset();
  if (events_) events_->restart();  // the reset took its transfers back
}

Result<void> UsbTransport::reopen() {
  assert(!stream_);
  if (!gone_ && libusb_reset_device(handle_->libusb()) == 0) return {};
  gone_ = true;
  auto found = find_probe(serial_);
  if (!found) return tl::unexpected<Error>(found.error());
  if (auto claimed = found->handle->claim(); !claimed) return claimed;
  handle_ = std::move(found->handle);
  gone_ = false;
  return {};
}

}  // namespace sonoloft::device
