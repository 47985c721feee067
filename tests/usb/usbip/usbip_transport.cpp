#include "tests/usb/usbip/usbip_transport.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "protocol/command.h"
#include "protocol/usb.h"
#include "tests/support/wire_slices.h"

namespace sonoloft::test {
namespace {

constexpr std::size_t kTransfers = 4;
constexpr std::uint8_t kVendorOut = 0x41, kVendorIn = 0xC1;

tl::unexpected<Error> gone() {
  return fail(ErrorCode::transport_closed, "the connection was closed");
}

}  // namespace

UsbipTransport::UsbipTransport(std::uint16_t tcp_port) : client_(tcp_port) {
  REQUIRE(client_.import() == 0);
  reader_ = std::jthread([this] { read_replies(); });
}

UsbipTransport::~UsbipTransport() {
  client_.shut_down();
}

void UsbipTransport::read_replies() {
  auto reply = client_.next_reply();
  for (; reply; reply = client_.next_reply()) {
    const std::lock_guard lock(mutex_);
    replies_[reply->seqnum] = std::move(*reply);
    changed_.notify_all();
  }
  const std::lock_guard lock(mutex_);
  gone_ = true;
  changed_.notify_all();
}

Result<UsbipClient::Reply> UsbipTransport::wait_for(std::uint32_t seqnum, std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, timeout, [&] { return gone_ || replies_.contains(seqnum); });
  const auto found = replies_.find(seqnum);
  if (found == replies_.end()) return gone_ ? gone() : fail(ErrorCode::timed_out, "no reply");
  Reply reply = std::move(found->second);
  replies_.erase(found);
  return reply;
}

Result<std::size_t> UsbipTransport::control(std::span<const std::byte> request, std::span<std::byte> reply,
                                            std::chrono::milliseconds timeout) {
  using namespace protocol::usb;
  const auto submit = [&](auto... arguments) {
    const std::lock_guard lock(write_mutex_);
    return client_.submit_control(arguments...);
  };
  const auto sent = wait_for(
      submit(kVendorOut, kSendRequest, std::uint16_t{0}, static_cast<std::uint16_t>(request.size()), request), timeout);
  if (!sent) return tl::unexpected<Error>(sent.error());
  if (sent->status != 0) return fail(ErrorCode::io_failed, "the request was not taken");
  const auto got = wait_for(submit(kVendorIn, kReadReply, std::uint16_t{0},
                                   static_cast<std::uint16_t>(protocol::kMaxRequestLen), std::span<const std::byte>{}),
                            timeout);
  if (!got) return tl::unexpected<Error>(got.error());
  std::copy(got->data.begin(), got->data.end(), reply.begin());
  return got->data.size();
}

Result<void> UsbipTransport::start_stream(device::TransferSink& sink, std::size_t max_record) {
  transfer_size_ = (max_record + 1023) / 1024 * 1024;
  stopping_ = false;
  stream_thread_ = std::jthread([this, &sink] { pass_on(sink); });
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
}

void UsbipTransport::pass_on(device::TransferSink& sink) {
  AlignedBytes record(transfer_size_);
  std::unique_lock lock(mutex_);
  while (!stopping_ && !gone_) {
    while (in_flight_.size() < kTransfers) {
      const std::lock_guard write(write_mutex_);
      in_flight_.push_back(client_.submit(1, static_cast<std::uint32_t>(transfer_size_)));
    }
    changed_.wait(lock, [&] { return stopping_ || gone_ || replies_.contains(in_flight_.front()); });
    const auto found = replies_.find(in_flight_.front());
    if (found == replies_.end()) continue;
    in_flight_.pop_front();
    const Reply reply = std::move(found->second);
    replies_.erase(found);
    lock.unlock();
    std::copy(reply.data.begin(), reply.data.end(), record.bytes().begin());
    sink.on_transfer(record.first(reply.data.size()));
    lock.lock();
  }
  if (gone_ && !stopping_) {
    lock.unlock();
    return sink.on_gone();
  }
  lock.unlock();
  for (const std::uint32_t seqnum : in_flight_) {
    std::uint32_t unlink = 0;
    {
      const std::lock_guard write(write_mutex_);
      unlink = client_.unlink(seqnum);
    }
    const auto unlinked = wait_for(unlink, std::chrono::seconds(60));
    if (!unlinked || unlinked->status != 0) continue;
    const auto finished = wait_for(seqnum, std::chrono::seconds(60));
    if (!finished || finished->status != 0) continue;
    std::copy(finished->data.begin(), finished->data.end(), record.bytes().begin());
    sink.on_transfer(record.first(finished->data.size()));
  }
  in_flight_.clear();
}

}  // namespace sonoloft::test
