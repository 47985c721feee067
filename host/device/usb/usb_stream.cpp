#include "host/device/usb/usb_stream.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <utility>

#include "host/device/usb/usb_error.h"
#include "protocol/record.h"

namespace sonoloft::device {
namespace {

constexpr std::chrono::seconds kPatience{2};  // with the kernel
// A device that is being unplugged may fail for a while before it is gone.
constexpr std::chrono::milliseconds kPauseAfterFailure{10};
constexpr int kMaxFailures = 50;

}  // namespace

UsbStream::UsbStream(libusb_device_handle* handle, std::uint8_t endpoint, libusb_transfer_type type, std::size_t count,
                     std::size_t size, TransferSink& sink)
    : handle_(handle), endpoint_(endpoint), sink_(sink), memory_(count * size + protocol::kRecordAlign), slots_(count) {
  void* first = memory_.data();
  std::size_t space = memory_.size();
  std::align(protocol::kRecordAlign, count * size, first, space);
  auto* buffer = static_cast<unsigned char*>(first);
  for (Slot& slot : slots_) {
    slot = {this, libusb_alloc_transfer(0)};
    libusb_fill_bulk_transfer(slot.transfer, handle_, endpoint_, buffer, static_cast<int>(size), on_completed, &slot,
                              0);
    slot.transfer->type = static_cast<unsigned char>(type);
    idle_.push_back(&slot);
    buffer += size;
  }
}

UsbStream::~UsbStream() {
  assert(active_ == 0 && !thread_.joinable());
  for (const Slot& slot : slots_) libusb_free_transfer(slot.transfer);
}

Result<void> UsbStream::begin() {
  const std::lock_guard lock(mutex_);
  submit_idle();
  if (gone_ || failed_) return usb_error(refusal_, "the USB stream cannot start");
  thread_ = std::jthread([this] { run(); });
  return {};
}

bool UsbStream::end() {
  {
    std::unique_lock lock(mutex_);
    stopping_ = true;
    cancel_all();
    wake_.notify_all();
    // The thread may be in the sink for as long as that likes; only the kernel's time counts.
    abandoned_ = !wake_.wait_for(lock, kPatience, [&] { return active_ == 0; });
    wake_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
  return !abandoned_;
}

void UsbStream::restart() {
  const std::lock_guard lock(mutex_);
  halted_ = true;
  cancel_all();
  wake_.notify_all();
}

void UsbStream::reset() {
  std::unique_lock lock(mutex_);
  resetting_ = halted_ = true;
  cancel_all();
  wake_.notify_all();
  wake_.wait_for(lock, kPatience, [&] { return !resetting_ || gone_; });
}

// ---- libusb's event thread

void UsbStream::on_completed(libusb_transfer* transfer) {
  Slot& slot = *static_cast<Slot*>(transfer->user_data);
  slot.stream->take_back(slot);
}

void UsbStream::take_back(Slot& slot) {
  const std::lock_guard lock(mutex_);
  --active_;
  if (slot.transfer->status == LIBUSB_TRANSFER_COMPLETED) {
    ready_.push_back(&slot);
  } else {
    idle_.push_back(&slot);
  }
  switch (slot.transfer->status) {
    case LIBUSB_TRANSFER_COMPLETED:
      failures_ = 0;
      break;
    case LIBUSB_TRANSFER_CANCELLED:
      break;
    case LIBUSB_TRANSFER_NO_DEVICE:
      gone_ = true;
      break;
    case LIBUSB_TRANSFER_STALL:
      halted_ = true;
      cancel_all();
      break;
    default:
      failed_ = true;
      break;
  }
  wake_.notify_all();
}

// ---- the stream's thread

void UsbStream::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [&] {
      return !ready_.empty() || abandoned_ || failed_ || (active_ == 0 && (stopping_ || gone_ || halted_));
    });
    if (!ready_.empty()) {
      hand_over(lock);
    } else if (stopping_) {
      if (active_ == 0 || abandoned_) return;
      failed_ = false;
    } else if (gone_ && active_ == 0) {
      lock.unlock();
      return sink_.on_gone();
    } else {
      mend(lock);
    }
  }
}

void UsbStream::hand_over(std::unique_lock<std::mutex>& lock) {
  Slot& slot = *ready_.front();
  ready_.pop_front();
  lock.unlock();
  const auto* bytes = reinterpret_cast<const std::byte*>(slot.transfer->buffer);
  sink_.on_transfer({bytes, static_cast<std::size_t>(slot.transfer->actual_length)});
  lock.lock();
  // While a halt waits to be cleared nothing may go out.
  if (stopping_ || gone_ || halted_) {
    idle_.push_back(&slot);
  } else {
    submit(slot);
  }
}

void UsbStream::mend(std::unique_lock<std::mutex>& lock) {
  if (halted_ && active_ == 0) {
    halted_ = false;
    const bool reset = resetting_;
    lock.unlock();
    const int mended = reset ? libusb_reset_device(handle_) : libusb_clear_halt(handle_, endpoint_);
    lock.lock();
    if (reset) resetting_ = false;
    wake_.notify_all();
    // A device that is another one after a reset has to be opened again.
    if (mended == LIBUSB_ERROR_NO_DEVICE || (reset && mended != 0)) gone_ = true;
  } else if (failed_) {
    failed_ = false;
    if (++failures_ > kMaxFailures) gone_ = true;
    wake_.wait_for(lock, kPauseAfterFailure, [&] { return stopping_ || gone_; });
  }
  if (!stopping_ && !gone_ && !halted_) submit_idle();
  if (gone_) cancel_all();
}

void UsbStream::submit(Slot& slot) {
  const int status = libusb_submit_transfer(slot.transfer);
  if (status == 0) {
    ++active_;
    return;
  }
  refusal_ = status;
  idle_.push_back(&slot);
  (status == LIBUSB_ERROR_NO_DEVICE ? gone_ : failed_) = true;
}

void UsbStream::submit_idle() {
  for (Slot* slot : std::exchange(idle_, {})) submit(*slot);
}

void UsbStream::cancel_all() {
  for (const Slot& slot : slots_) libusb_cancel_transfer(slot.transfer);
}

}  // namespace sonoloft::device
