#include "host/device/usb/usb_monitor.h"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

#include "host/device/usb/usb_context.h"
#include "host/device/usb/usb_error.h"
#include "host/device/usb/usb_search.h"
#include "protocol/usb.h"

namespace sonoloft::device {

struct UsbMonitor::State {
  std::shared_ptr<UsbContext> context;
  Callback callback;
  libusb_hotplug_callback_handle registration = 0;

  std::mutex mutex;
  std::condition_variable changed;
  std::deque<UsbPlugEvent> events;
  bool stopping = false;
  std::jthread thread;

  static int LIBUSB_CALL on_event(libusb_context*, libusb_device* device, libusb_hotplug_event event, void* self) {
    auto& state = *static_cast<State*>(self);
    const std::lock_guard lock(state.mutex);
    state.events.push_back({event == LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED, location(device)});
    state.changed.notify_all();
    return 0;
  }

  void tell() {
    std::unique_lock lock(mutex);
    while (true) {
      changed.wait(lock, [&] { return stopping || !events.empty(); });
      if (stopping) return;
      const UsbPlugEvent event = std::move(events.front());
      events.pop_front();
      lock.unlock();
      callback(event);
      lock.lock();
    }
  }
};

Result<std::unique_ptr<UsbMonitor>> UsbMonitor::start(Callback callback) {
  auto context = UsbContext::get();
  if (!context) return tl::unexpected<Error>(context.error());
  if (libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) == 0) {
    return fail(ErrorCode::not_available, "this system does not tell of USB devices that come and go: list them");
  }
  auto state = std::make_unique<State>();
  state->context = std::move(*context);
  state->callback = std::move(callback);
  const int status = libusb_hotplug_register_callback(
      state->context->libusb(), LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT,
      LIBUSB_HOTPLUG_ENUMERATE, protocol::usb::kVendorId, protocol::usb::kProductId, LIBUSB_HOTPLUG_MATCH_ANY,
      State::on_event, state.get(), &state->registration);
  if (status != 0) return usb_error(status, "USB devices that come and go cannot be watched");
  state->thread = std::jthread([raw = state.get()] { raw->tell(); });
  return std::unique_ptr<UsbMonitor>(new UsbMonitor(std::move(state)));
}

UsbMonitor::UsbMonitor(std::unique_ptr<State> state) : state_(std::move(state)) {}

UsbMonitor::~UsbMonitor() {
  libusb_hotplug_deregister_callback(state_->context->libusb(), state_->registration);
  {
    const std::lock_guard lock(state_->mutex);
    state_->stopping = true;
    state_->changed.notify_all();
  }
  state_->thread.join();
}

}  // namespace sonoloft::device
