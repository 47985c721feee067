#include "host/device/usb/usb_handle.h"

#include <array>
#include <cassert>
#include <cstring>
#include <future>
#include <vector>

#include "host/device/usb/usb_error.h"
#include "protocol/usb.h"

namespace sonoloft::device {
namespace {

constexpr std::chrono::milliseconds kPatience{1000};
constexpr std::chrono::milliseconds kGrace{2000};  // for the kernel to give a transfer back

bool is_ours(const libusb_interface_descriptor& d) {
  return d.bInterfaceClass == protocol::usb::kInterfaceClass &&
         d.bInterfaceSubClass == protocol::usb::kInterfaceSubclass &&
         d.bInterfaceProtocol == protocol::usb::kInterfaceProtocol;
}

// The first of each kind.
std::optional<UsbInterface> endpoints_of(const libusb_interface_descriptor& d) {
  UsbInterface found{d.bInterfaceNumber, 0};
  for (int i = 0; i < d.bNumEndpoints; ++i) {
    const auto& endpoint = d.endpoint[i];
    const int type = endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK;
    const bool in = (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_IN) != 0;
    std::uint8_t* place = nullptr;
    if (type == LIBUSB_TRANSFER_TYPE_BULK) place = in ? &found.stream_in : &found.blob_out;
    if (type == LIBUSB_TRANSFER_TYPE_INTERRUPT && in) place = &found.event_in;
    if (place != nullptr && *place == 0) *place = endpoint.bEndpointAddress;
  }
  return found.stream_in == 0 ? std::nullopt : std::optional(found);
}

}  // namespace

// A transfer under way. It belongs to its callback, so that one which comes back late does no harm.
struct UsbHandle::Transfer {
  explicit Transfer(std::size_t len) : buffer(len) {}
  ~Transfer() { libusb_free_transfer(transfer); }
  static void LIBUSB_CALL end(libusb_transfer* transfer) {
    const std::unique_ptr<std::shared_ptr<Transfer>> mine(static_cast<std::shared_ptr<Transfer>*>(transfer->user_data));
    (*mine)->ended.set_value();
  }

  libusb_transfer* transfer = libusb_alloc_transfer(0);
  std::vector<unsigned char> buffer;
  std::promise<void> ended;
};

std::optional<UsbInterface> find_interface(libusb_device* device) {
  libusb_device_descriptor of_device;
  if (libusb_get_device_descriptor(device, &of_device) != 0) return std::nullopt;
  if (of_device.idVendor != protocol::usb::kVendorId || of_device.idProduct != protocol::usb::kProductId) {
    return std::nullopt;
  }
  libusb_config_descriptor* config = nullptr;
  if (libusb_get_active_config_descriptor(device, &config) != 0) return std::nullopt;
  std::optional<UsbInterface> found;
  for (int i = 0; i < config->bNumInterfaces && !found; ++i) {
    const libusb_interface& interface = config->interface[i];
    if (interface.num_altsetting > 0 && is_ours(interface.altsetting[0])) found = endpoints_of(interface.altsetting[0]);
  }
  libusb_free_config_descriptor(config);
  return found;
}

Result<std::unique_ptr<UsbHandle>> UsbHandle::open(std::shared_ptr<UsbContext> context, libusb_device* device,
                                                   const UsbInterface& interface) {
  libusb_device_handle* handle = nullptr;
  if (const int status = libusb_open(device, &handle); status != 0) {
    return usb_error(status, "the USB probe cannot be opened");
  }
  return std::unique_ptr<UsbHandle>(new UsbHandle(std::move(context), handle, interface));
}

UsbHandle::~UsbHandle() {
  if (abandoned_) {
    // The context must outlive what is still in flight, too.
    [[maybe_unused]] const auto* leaked = new std::shared_ptr<UsbContext>(std::move(context_));
    return;
  }
  if (claimed_) libusb_release_interface(handle_, interface_.number);
  libusb_close(handle_);
}

Result<void> UsbHandle::claim() {
  if (const int status = libusb_claim_interface(handle_, interface_.number); status != 0) {
    return usb_error(status, "the USB probe cannot be used");
  }
  claimed_ = true;
  return {};
}

Result<std::size_t> UsbHandle::control(const libusb_control_setup& setup, std::span<std::byte> data,
                                       std::chrono::milliseconds timeout) {
  const std::string what = "USB request " + std::to_string(setup.bRequest);
  const bool in = (setup.bmRequestType & LIBUSB_ENDPOINT_IN) != 0;
  const auto control = std::make_shared<Transfer>(LIBUSB_CONTROL_SETUP_SIZE + data.size());
  std::memcpy(control->buffer.data(), &setup, LIBUSB_CONTROL_SETUP_SIZE);
  if (!in) std::memcpy(control->buffer.data() + LIBUSB_CONTROL_SETUP_SIZE, data.data(), data.size());
  libusb_fill_control_transfer(control->transfer, handle_, control->buffer.data(), Transfer::end, nullptr,
                               static_cast<unsigned>(timeout.count()));
  auto size = finish(control, timeout, what);
  if (size && in) std::memcpy(data.data(), control->buffer.data() + LIBUSB_CONTROL_SETUP_SIZE, *size);
  return size;
}

Result<void> UsbHandle::write(std::uint8_t endpoint, std::span<const std::byte> data,
                              std::chrono::milliseconds timeout) {
  const auto bulk = std::make_shared<Transfer>(data.size());
  std::memcpy(bulk->buffer.data(), data.data(), data.size());
  libusb_fill_bulk_transfer(bulk->transfer, handle_, endpoint, bulk->buffer.data(), static_cast<int>(data.size()),
                            Transfer::end, nullptr, static_cast<unsigned>(timeout.count()));
  const auto size = finish(bulk, timeout, "a USB transfer to the probe");
  if (size) return {};
  if (size.error().code == ErrorCode::io_failed) (void)libusb_clear_halt(handle_, endpoint);
  return tl::unexpected<Error>(size.error());
}

// Submits it and waits for its end. @return the bytes moved
Result<std::size_t> UsbHandle::finish(const std::shared_ptr<Transfer>& transfer, std::chrono::milliseconds timeout,
                                      const std::string& what) {
  auto ended = transfer->ended.get_future();
  auto callbacks_share = std::make_unique<std::shared_ptr<Transfer>>(transfer);
  transfer->transfer->user_data = callbacks_share.get();
  if (const int status = libusb_submit_transfer(transfer->transfer); status != 0) return usb_error(status, what);
  (void)callbacks_share.release();
  if (ended.wait_for(timeout + kGrace) != std::future_status::ready) {
    abandon();
    return transfer_error(LIBUSB_TRANSFER_NO_DEVICE, what);
  }
  const libusb_transfer& done = *transfer->transfer;
  if (done.status != LIBUSB_TRANSFER_COMPLETED) return transfer_error(done.status, what);
  return static_cast<std::size_t>(done.actual_length);
}

Result<std::string> UsbHandle::serial() {
  constexpr std::uint16_t kEnglish = 0x0409;
  libusb_device_descriptor of_device;
  libusb_get_device_descriptor(libusb_get_device(handle_), &of_device);
  std::array<std::byte, 255> text;
  const libusb_control_setup setup{
      LIBUSB_ENDPOINT_IN, LIBUSB_REQUEST_GET_DESCRIPTOR,
      libusb_cpu_to_le16(static_cast<std::uint16_t>(LIBUSB_DT_STRING << 8 | of_device.iSerialNumber)),
      libusb_cpu_to_le16(kEnglish), libusb_cpu_to_le16(text.size())};
  const auto size = control(setup, text, kPatience);
  if (!size) return tl::unexpected<Error>(size.error());
  std::string serial;
  for (std::size_t i = 2; i + 1 < *size; i += 2) serial += static_cast<char>(text[i]);
  if (of_device.iSerialNumber == 0 || serial.empty()) {
    return fail(ErrorCode::protocol_mismatch, "the USB probe has no serial number: update its firmware");
  }
  return serial;
}

}  // namespace sonoloft::device
