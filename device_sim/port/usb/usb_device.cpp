#include "device_sim/port/usb/usb_device.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "protocol/event.h"
#include "protocol/usb.h"

namespace sonoloft::device_sim::usb {

using protocol::PortStatus;

namespace {

constexpr std::uint32_t kReadTimeoutMs = 50;
constexpr std::size_t kMaxBlock = 1u << 16;  // more than any firmware takes at once

enum StandardRequest : std::uint8_t {
  kGetStatus = 0,
  kClearFeature = 1,
  kSetFeature = 3,
  kSetAddress = 5,
  kGetDescriptor = 6,
  kGetConfiguration = 8,
  kSetConfiguration = 9,
  kGetInterface = 10,
  kSetInterface = 11,
};

// bmRequestType without its direction.
constexpr std::uint8_t kKindMask = 0x60, kStandard = 0x00, kVendor = 0x40;
constexpr std::uint8_t kRecipientMask = 0x1F, kToInterface = 1, kToEndpoint = 2;
constexpr std::uint16_t kEndpointHalt = 0;
constexpr std::uint16_t kMsOsDescriptorIndex = 7;

std::uint8_t recipient(const SetupPacket& setup) {
  return setup.request_type & kRecipientMask;
}

bool is_endpoint(std::uint16_t address) {
  return address == 0 || address == kStreamIn || address == kEventIn || address == kBlobOut;
}

}  // namespace

UsbDevice::UsbDevice(protocol::Port& port, const UsbIdentity& identity, const UrbSink& done)
    : port_(port),
      descriptors_(identity.serial),
      done_(done),
      stream_(
          kHighSpeedPacket, identity.max_record,
          [&port](std::span<std::byte> record) { return port.read(record, kReadTimeoutMs); }, done),
      events_(
          kEventPacket, protocol::kEventLen,
          [&port](std::span<std::byte> event) { return port.read_event(event, kReadTimeoutMs); }, done),
      blobs_(
          kHighSpeedPacket, kMaxBlock, [&port](std::span<const std::byte> block) { return port.write_block(block); },
          done) {
  port_.allow_reads();
  control_thread_ = std::jthread([this] { serve_control(); });
}

UsbDevice::~UsbDevice() {
  port_.cancel_reads();
  const std::lock_guard lock(mutex_);
  closing_ = true;
  wake_.notify_all();
}

void UsbDevice::submit(Urb urb) {
  if (urb.endpoint == kStreamIn) return stream_.submit(urb.id, urb.room);
  if (urb.endpoint == kEventIn) return events_.submit(urb.id, urb.room);
  if (urb.endpoint == kBlobOut) return blobs_.submit(std::move(urb));
  const std::lock_guard lock(mutex_);
  if (urb.endpoint != 0) return done_({urb.id, UrbStatus::stalled, {}, 0});
  control_.push_back(std::move(urb));
  wake_.notify_all();
}

bool UsbDevice::unlink(std::uint64_t id) {
  if (stream_.unlink(id) || events_.unlink(id) || blobs_.unlink(id)) return true;
  const std::lock_guard lock(mutex_);
  if (serving_ == id) {
    serving_.reset();
    return true;
  }
  return std::erase(unanswered_, id) != 0 || std::erase_if(control_, [&](const Urb& urb) { return urb.id == id; }) != 0;
}

void UsbDevice::reset() {
  stream_.reset();
  events_.reset();
  blobs_.reset();
  const std::lock_guard lock(mutex_);
  control_.clear();
  unanswered_.clear();
  serving_.reset();
  configuration_ = 0;
}

// ---- the control thread

void UsbDevice::serve_control() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [&] { return closing_ || !control_.empty(); });
    if (closing_) return;
    const Urb urb = std::move(control_.front());
    control_.pop_front();
    serving_ = urb.id;
    lock.unlock();
    const Answer a = answer(urb);
    lock.lock();
    if (std::exchange(serving_, {}) != urb.id) continue;
    if (a.never) {
      unanswered_.push_back(urb.id);
      continue;
    }
    if (!urb.setup.to_host()) {
      done_({urb.id, a.data.empty() ? a.status : UrbStatus::stalled, {}, urb.data.size()});
      continue;
    }
    const auto data = a.data.first(std::min<std::size_t>(a.data.size(), urb.setup.length));
    done_({urb.id, a.status, data, data.size()});
  }
}

UsbDevice::Answer UsbDevice::answer(const Urb& urb) {
  switch (urb.setup.request_type & kKindMask) {
    case kStandard:
      return answer_standard(urb.setup);
    case kVendor:
      return answer_vendor(urb);
    default:
      return {UrbStatus::stalled};
  }
}

UsbDevice::Answer UsbDevice::answer_vendor(const Urb& urb) {
  using namespace protocol::usb;
  const SetupPacket& setup = urb.setup;
  if (setup.request == kMsOsRequest && setup.index == kMsOsDescriptorIndex && setup.to_host()) {
    return {UrbStatus::ok, descriptors_.microsoft()};
  }
  if (recipient(setup) != kToInterface || setup.index != 0) return {UrbStatus::stalled};
  if (setup.request == kReadReply && setup.to_host() && reply_len_ != 0) {
    return {UrbStatus::ok, std::span<const std::byte>(reply_).first(reply_len_)};
  }
  const bool fits = urb.data.size() >= sizeof(protocol::RequestHeader) && urb.data.size() <= protocol::kMaxRequestLen;
  if (setup.request != kSendRequest || setup.to_host() || !fits) return {UrbStatus::stalled};
  reply_len_ = 0;
  const auto replied = port_.control(urb.data, reply_);
  if (replied.status == PortStatus::gone) return {UrbStatus::gone};
  if (replied.status == PortStatus::timed_out) return {UrbStatus::ok, {}, true};
  if (replied.status != PortStatus::ok) return {UrbStatus::stalled};
  reply_len_ = replied.size;
  return {UrbStatus::ok};
}

UsbDevice::Answer UsbDevice::answer_standard(const SetupPacket& setup) {
  switch (setup.request) {
    case kGetStatus:
      return status_of(setup);
    case kClearFeature:
      return feature(setup, false);
    case kSetFeature:
      return feature(setup, true);
    case kSetAddress:
      return {UrbStatus::ok};
    case kGetDescriptor: {
      const auto found = descriptors_.find(setup.value);
      return found ? Answer{UrbStatus::ok, *found} : Answer{UrbStatus::stalled};
    }
    case kGetConfiguration: {
      const std::lock_guard lock(mutex_);
      return short_answer(configuration_, 1);
    }
    case kSetConfiguration: {
      if (setup.value > kConfiguration) return {UrbStatus::stalled};
      clear_halts();
      const std::lock_guard lock(mutex_);
      configuration_ = static_cast<std::uint8_t>(setup.value);
      return {UrbStatus::ok};
    }
    case kGetInterface:
      return setup.index == 0 ? short_answer(0, 1) : Answer{UrbStatus::stalled};
    case kSetInterface:
      if (setup.index != 0 || setup.value != 0) return {UrbStatus::stalled};
      clear_halts();
      return {UrbStatus::ok};
    default:
      return {UrbStatus::stalled};
  }
}

UsbDevice::Answer UsbDevice::status_of(const SetupPacket& setup) {
  if (recipient(setup) != kToEndpoint) return short_answer(0, 2);
  if (!is_endpoint(setup.index)) return {UrbStatus::stalled};
  return short_answer(halted(setup.index) ? 1 : 0, 2);
}

UsbDevice::Answer UsbDevice::feature(const SetupPacket& setup, bool set) {
  if (recipient(setup) != kToEndpoint || setup.value != kEndpointHalt) return {UrbStatus::stalled};
  if (!is_endpoint(setup.index)) return {UrbStatus::stalled};
  if (set) {
    halt(setup.index);
  } else {
    clear_halt(setup.index);
  }
  return {UrbStatus::ok};
}

bool UsbDevice::halted(std::uint16_t endpoint) const {
  return (endpoint == kStreamIn && stream_.halted()) || (endpoint == kEventIn && events_.halted()) ||
         (endpoint == kBlobOut && blobs_.halted());
}

void UsbDevice::halt(std::uint16_t endpoint) {
  if (endpoint == kStreamIn) stream_.halt();
  if (endpoint == kEventIn) events_.halt();
  if (endpoint == kBlobOut) blobs_.halt();
}

void UsbDevice::clear_halt(std::uint16_t endpoint) {
  if (endpoint == kStreamIn) {
    port_.clear_halt();
    stream_.clear_halt();
  }
  if (endpoint == kEventIn) events_.clear_halt();
  if (endpoint == kBlobOut) blobs_.clear_halt();
}

void UsbDevice::clear_halts() {
  for (const std::uint16_t endpoint : {kStreamIn, kEventIn, kBlobOut}) clear_halt(endpoint);
}

UsbDevice::Answer UsbDevice::short_answer(std::uint16_t number, std::size_t len) {
  number_ = {static_cast<std::byte>(number & 0xFF), static_cast<std::byte>(number >> 8)};
  return {UrbStatus::ok, std::span<const std::byte>(number_).first(len)};
}

}  // namespace sonoloft::device_sim::usb
