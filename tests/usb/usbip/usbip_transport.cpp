#include "tests/usb/usbip/usbip_transport.h"

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <utility>

#include "protocol/command.h"
#include "protocol/usb.h"
#include "tests/support/wire/wire_slices.h"

namespace sonoloft::test {
namespace {

constexpr std::size_t kTransfers = 4, kEventRoom = 64;
constexpr std::uint32_t kStream = 1, kEvents = 2, kBlobs = 1;
constexpr std::uint8_t kVendorOut = 0x41, kVendorIn = 0xC1;
constexpr std::uint8_t kToEndpoint = 0x02, kClearFeature = 1;
constexpr std::uint16_t kEndpointHalt = 0, kStreamIn = 0x81;
constexpr std::chrono::seconds kServersPatience{60};  // it answers an unlink at once

tl::unexpected<Error> gone() {
  return fail(ErrorCode::transport_closed, "the connection was closed");
}

}  // namespace

UsbipTransport::UsbipTransport(std::uint16_t tcp_port) : client_(tcp_port) {
  if (client_.import() != 0) throw std::runtime_error("the USB/IP server has another host");
  reader_ = std::jthread([this] { read_replies(); });
}

UsbipTransport::~UsbipTransport() {
  client_.shut_down();
}

void UsbipTransport::read_replies() {
  for (auto reply = client_.next_reply(); reply; reply = client_.next_reply()) {
    const std::lock_guard lock(mutex_);
    gone_ |= reply->status == -ENODEV;
    replies_[reply->seqnum] = std::move(*reply);
    changed_.notify_all();
  }
  const std::lock_guard lock(mutex_);
  gone_ = true;
  changed_.notify_all();
}

template <class Submit>
std::uint32_t UsbipTransport::submit(const Submit& submit) {
  const std::lock_guard lock(write_mutex_);
  return submit();
}

std::optional<UsbipTransport::Reply> UsbipTransport::take(std::uint32_t seqnum) {
  auto node = replies_.extract(seqnum);
  return node ? std::optional(std::move(node.mapped())) : std::nullopt;
}

std::optional<UsbipTransport::Reply> UsbipTransport::take_back(Lock& lock, std::uint32_t seqnum) {
  if (auto ended = take(seqnum); ended || gone_) return ended;
  const auto unlink = submit([&] { return client_.unlink(seqnum); });
  changed_.wait_for(lock, kServersPatience, [&] { return gone_ || replies_.contains(unlink); });
  (void)take(unlink);
  return take(seqnum);
}

Result<UsbipTransport::Reply> UsbipTransport::finish(std::uint32_t seqnum, std::chrono::milliseconds timeout) {
  Lock lock(mutex_);
  changed_.wait_for(lock, timeout, [&] { return gone_ || replies_.contains(seqnum); });
  const auto reply = take_back(lock, seqnum);
  if (reply && reply->status == 0) return *reply;
  if (gone_) return gone();
  return reply ? fail(ErrorCode::io_failed, "the request was not taken") : fail(ErrorCode::timed_out, "no reply");
}

Result<std::size_t> UsbipTransport::control(std::span<const std::byte> request, std::span<std::byte> reply,
                                            std::chrono::milliseconds timeout) {
  using namespace protocol::usb;
  const auto sent = finish(submit([&] {
                             return client_.submit_control(kVendorOut, kSendRequest, 0,
                                                           static_cast<std::uint16_t>(request.size()), request);
                           }),
                           timeout);
  if (!sent) return tl::unexpected<Error>(sent.error());
  const auto got = finish(submit([&] {
                            return client_.submit_control(kVendorIn, kReadReply, 0,
                                                          static_cast<std::uint16_t>(protocol::kMaxRequestLen));
                          }),
                          timeout);
  if (!got) return tl::unexpected<Error>(got.error());
  std::copy(got->data.begin(), got->data.end(), reply.begin());
  return got->data.size();
}

Result<void> UsbipTransport::start_stream(device::TransferSink& sink, std::size_t max_record) {
  transfer_size_ = (max_record + 1023) / 1024 * 1024;
  stopping_ = false;
  clear_halt();  // throws away what was left of a record, too
  stream_thread_ = std::jthread([this, &sink] { pass_on(sink); });
  events_thread_ = std::jthread([this, &sink] { pass_on_events(sink); });
  return {};
}

void UsbipTransport::stop_stream() {
  if (!stream_thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    changed_.notify_all();
  }
  stream_thread_.join();
  events_thread_.join();
}

Result<void> UsbipTransport::send_block(std::span<const std::byte> block, std::chrono::milliseconds timeout) {
  const auto sent = finish(submit([&] { return client_.submit_out(kBlobs, block); }), timeout);
  if (!sent) return tl::unexpected<Error>(sent.error());
  return {};
}

// ---- the stream's thread

void UsbipTransport::pass_on(device::TransferSink& sink) {
  Lock lock(mutex_);
  while (!stopping_ && !gone_) {
    submit_transfers();
    changed_.wait(lock, [&] { return stopping_ || gone_ || replies_.contains(in_flight_.front()); });
    const auto reply = take(in_flight_.front());
    if (!reply) continue;
    in_flight_.pop_front();
    if (reply->status == 0) {
      hand_over(lock, *reply, sink);
    } else if (reply->status == -EPIPE) {
      take_all_back(lock, sink);
      lock.unlock();
      clear_halt();
      lock.lock();
    }
  }
  take_all_back(lock, sink);
  if (!gone_ || stopping_) return;
  lock.unlock();
  sink.on_gone();
}

void UsbipTransport::pass_on_events(device::TransferSink& sink) {
  Lock lock(mutex_);
  while (!stopping_ && !gone_) {
    const auto asked = submit([&] { return client_.submit(kEvents, kEventRoom); });
    changed_.wait(lock, [&] { return stopping_ || gone_ || replies_.contains(asked); });
    const auto reply = take_back(lock, asked);
    if (!reply || reply->status != 0) continue;
    lock.unlock();
    sink.on_event(reply->data);
    lock.lock();
  }
}

void UsbipTransport::submit_transfers() {
  const auto size = static_cast<std::uint32_t>(transfer_size_);
  while (in_flight_.size() < kTransfers) in_flight_.push_back(submit([&] { return client_.submit(kStream, size); }));
}

void UsbipTransport::hand_over(Lock& lock, const Reply& reply, device::TransferSink& sink) {
  lock.unlock();
  AlignedBytes record(transfer_size_);
  std::copy(reply.data.begin(), reply.data.end(), record.bytes().begin());
  sink.on_transfer(record.first(reply.data.size()));
  lock.lock();
}

void UsbipTransport::take_all_back(Lock& lock, device::TransferSink& sink) {
  for (const std::uint32_t seqnum : std::exchange(in_flight_, {})) {
    const auto ended = take_back(lock, seqnum);
    if (ended && ended->status == 0) hand_over(lock, *ended, sink);
  }
}

void UsbipTransport::clear_halt() {
  const auto cleared =
      submit([&] { return client_.submit_control(kToEndpoint, kClearFeature, kEndpointHalt, 0, {}, kStreamIn); });
  (void)finish(cleared, kServersPatience);  // what fails here fails below
}

}  // namespace sonoloft::test
