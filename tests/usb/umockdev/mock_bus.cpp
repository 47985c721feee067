#include "tests/usb/umockdev/mock_bus.h"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

namespace sonoloft::test {

using device_sim::usb::Descriptors;
using device_sim::usb::SetupPacket;
using device_sim::usb::Urb;
using device_sim::usb::UrbDone;
using device_sim::usb::UrbStatus;

namespace {

constexpr std::uint32_t kCapabilities =
    USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;

int errno_of(UrbStatus status) {
  switch (status) {
    case UrbStatus::ok:
      return 0;
    case UrbStatus::stalled:
      return -EPIPE;
    case UrbStatus::overflow:
      return -EOVERFLOW;
    case UrbStatus::gone:
      break;
  }
  return -ENODEV;
}

std::string hex(std::span<const std::byte> bytes) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  std::string text;
  for (const std::byte b : bytes) {
    text += kDigits[std::to_integer<int>(b) >> 4];
    text += kDigits[std::to_integer<int>(b) & 15];
  }
  return text;
}

std::string node_of(int address) {
  const std::string number = std::to_string(address + 1);
  return "/dev/bus/usb/001/" + std::string(3 - number.size(), '0') + number;
}

}  // namespace

MockBus::MockBus() : testbed_(umockdev_testbed_new()) {
  gchar* root = umockdev_testbed_get_root_dir(testbed_);
  root_ = root;
  g_free(root);
  std::filesystem::permissions(root_, std::filesystem::perms(0755));  // as /sys and /dev are
  std::filesystem::create_directories(root_ + "/dev/bus/usb/001");
}

MockBus::~MockBus() {
  g_object_unref(testbed_);
}

void MockBus::write_sys(const std::string& path, const std::string& text) const {
  const std::filesystem::path file = root_ + "/sys/" + path;
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

MockProbe::MockProbe(MockBus& bus, int address, protocol::Port& port, const device_sim::usb::UsbIdentity& identity)
    : bus_(bus),
      address_(address),
      node_(node_of(address)),
      syspath_("/sys/devices/usb1/1-" + std::to_string(address)),
      handler_(umockdev_ioctl_base_new()) {
  device_.emplace(port, identity, [this](const UrbDone& done) { complete(done); });

  master_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  REQUIRE(master_ >= 0);
  REQUIRE(grantpt(master_) == 0);
  REQUIRE(unlockpt(master_) == 0);
  terminal_ = ptsname(master_);
  slave_ = open(terminal_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  REQUIRE(slave_ >= 0);
  show_readiness();
  std::filesystem::remove(bus.root() + node_);
  std::filesystem::create_symlink(terminal_, bus.root() + node_);

  // The node, then its ioctls, then the device: adding it tells libusb, which opens it at once.
  g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(on_ioctl), this);
  REQUIRE(umockdev_testbed_attach_ioctl(bus.testbed(), node_.c_str(), handler_, nullptr) != 0);
  REQUIRE(umockdev_testbed_add_from_string(bus.testbed(), description(device_->descriptors(), identity.serial).c_str(),
                                           nullptr) != 0);
}

MockProbe::~MockProbe() {
  unplug();
  umockdev_testbed_detach_ioctl(bus_.testbed(), node_.c_str(), nullptr);
  g_object_unref(handler_);
  close(slave_);
}

std::string MockProbe::description(const Descriptors& descriptors, const std::string& serial) const {
  const auto device = *descriptors.find(0x0100), configuration = *descriptors.find(0x0200);
  const auto number = std::to_string(address_ + 1);
  const auto usb_id = [&](std::size_t at) { return hex(device.subspan(at + 1, 1)) + hex(device.subspan(at, 1)); };
  return "P: " + syspath_.substr(4) +
         "\n"
         "E: SUBSYSTEM=usb\n"
         "E: DEVTYPE=usb_device\n"
         "E: BUSNUM=001\n"
         "E: DEVNUM=" +
         node_.substr(node_.size() - 3) + "\nE: DEVNAME=" + node_ +
         "\n"
         "A: bConfigurationValue=1\\n\n"
         "A: busnum=1\\n\n"
         "A: devnum=" +
         number + "\\n\nA: speed=480\\n\nA: idVendor=" + usb_id(8) + "\\n\nA: idProduct=" + usb_id(10) +
         "\\n\nA: serial=" + serial + "\\n\nH: descriptors=" + hex(device) + hex(configuration) + "\n";
}

void MockProbe::unplug() {
  std::map<std::uint64_t, Waiting> waiting;
  {
    const std::lock_guard lock(mutex_);
    if (gone_) return;
    gone_ = true;
    waiting = std::exchange(waiting_, {});
    answered_.notify_all();
  }
  {
    const std::lock_guard lock(device_mutex_);
    device_.reset();
  }
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, urb] : waiting) done_.push_back({urb.urb, -ENODEV});
  }
  close(master_);
  std::filesystem::remove(bus_.root() + node_);
  umockdev_testbed_uevent(bus_.testbed(), syspath_.c_str(), "remove");
  umockdev_testbed_remove_device(bus_.testbed(), syspath_.c_str());
}

void MockProbe::freeze_until(Cure cure, int times) {
  std::map<std::uint64_t, Waiting> waiting;
  {
    const std::lock_guard lock(mutex_);
    frozen_until_ = cure;
    cures_left_ = times;
    waiting = waiting_;
  }
  for (const auto& [id, urb] : waiting) {
    if (urb.endpoint != 0) unlink(id);
  }
}

void MockProbe::thaw(Cure cure) {
  const std::lock_guard lock(mutex_);
  if (frozen_until_ == cure && --cures_left_ == 0) frozen_until_.reset();
}

void MockProbe::submit(Urb urb) {
  const std::lock_guard lock(device_mutex_);
  if (device_) device_->submit(std::move(urb));
}

void MockProbe::unlink(std::uint64_t id) {
  const std::lock_guard lock(device_mutex_);
  if (device_) (void)device_->unlink(id);
}

void MockProbe::halt() {
  (void)request({0x02, 3, 0, device_sim::usb::kStreamIn, 0});
}

void MockProbe::forbid() {
  REQUIRE(chmod(terminal_.c_str(), 0) == 0);
  // umockdev asks for its own socket even where open() fails, and ends the process when it may not.
  REQUIRE(chmod((bus_.root() + "/ioctl" + node_).c_str(), 0666) == 0);
}

int MockProbe::clear_halts() const {
  const std::lock_guard lock(mutex_);
  return clear_halts_;
}

int MockProbe::resets() const {
  const std::lock_guard lock(mutex_);
  return resets_;
}

// ---- umockdev's thread

gboolean MockProbe::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
  UMockdevIoctlData* data = umockdev_ioctl_client_get_arg(client);
  void* argument = nullptr;
  std::memcpy(&argument, data->data, sizeof argument);
  const auto answer = static_cast<MockProbe*>(self)->ioctl(umockdev_ioctl_client_get_request(client), argument);
  if (!answer) return FALSE;
  umockdev_ioctl_client_complete(client, answer->result, answer->error);
  return TRUE;
}

// The arguments are addresses in this very process.
std::optional<MockProbe::Answer> MockProbe::ioctl(unsigned long number, void* argument) {
  switch (number) {
    case USBDEVFS_GET_CAPABILITIES:
      *static_cast<std::uint32_t*>(argument) = kCapabilities;
      return Answer{};
    case USBDEVFS_CLAIMINTERFACE:
    case USBDEVFS_RELEASEINTERFACE:
    case USBDEVFS_DISCONNECT_CLAIM:
      return Answer{};
    case USBDEVFS_GETDRIVER:
      return Answer{-1, ENODATA};
    case USBDEVFS_SETINTERFACE:
      return request({0x01, 11, 0, 0, 0});
    case USBDEVFS_CLEAR_HALT: {
      {
        const std::lock_guard lock(mutex_);
        ++clear_halts_;
      }
      thaw(Cure::clear_halt);
      return request({0x02, 1, 0, static_cast<std::uint16_t>(*static_cast<unsigned*>(argument)), 0});
    }
    case USBDEVFS_RESET: {
      {
        const std::lock_guard lock(mutex_);
        if (gone_) return Answer{-1, ENODEV};
        ++resets_;
      }
      thaw(Cure::reset);
      {
        const std::lock_guard lock(device_mutex_);
        if (device_) device_->reset();
      }
      return request({0x00, 9, 1, 0, 0});
    }
    case USBDEVFS_SUBMITURB:
      return submit(static_cast<usbdevfs_urb*>(argument));
    case USBDEVFS_DISCARDURB:
      return discard(static_cast<usbdevfs_urb*>(argument));
    case USBDEVFS_REAPURBNDELAY:
      return reap(static_cast<usbdevfs_urb**>(argument));
    default:
      return std::nullopt;
  }
}

MockProbe::Answer MockProbe::submit(usbdevfs_urb* urb) {
  Urb to_device;
  const auto* bytes = static_cast<const std::byte*>(urb->buffer);
  const auto size = static_cast<std::size_t>(urb->buffer_length);
  to_device.endpoint = urb->endpoint;
  to_device.room = size;
  if (urb->type == USBDEVFS_URB_TYPE_CONTROL) {
    to_device.endpoint = 0;
    std::memcpy(&to_device.setup, bytes, sizeof(SetupPacket));
    if (!to_device.setup.to_host()) to_device.data.assign(bytes + sizeof(SetupPacket), bytes + size);
  }
  if (urb->type == USBDEVFS_URB_TYPE_BULK && (urb->endpoint & 0x80) == 0) to_device.data.assign(bytes, bytes + size);
  {
    const std::lock_guard lock(mutex_);
    if (gone_) return {-1, ENODEV};
    to_device.id = next_id_++;
    waiting_.emplace(to_device.id, Waiting{urb, to_device.endpoint});
    if (to_device.endpoint != 0 && frozen_until_) return {};
  }
  submit(std::move(to_device));
  return {};
}

MockProbe::Answer MockProbe::discard(usbdevfs_urb* urb) {
  std::uint64_t id = 0;
  {
    const std::lock_guard lock(mutex_);
    const auto found =
        std::find_if(waiting_.begin(), waiting_.end(), [&](const auto& entry) { return entry.second.urb == urb; });
    if (found == waiting_.end()) return {-1, EINVAL};
    id = found->first;
  }
  unlink(id);
  const std::lock_guard lock(mutex_);
  if (waiting_.erase(id) == 0) return {-1, EINVAL};  // it has completed meanwhile
  urb->actual_length = 0;
  done_.push_back({urb, -ENOENT});
  show_readiness();
  return {};
}

MockProbe::Answer MockProbe::reap(usbdevfs_urb** urb) {
  const std::lock_guard lock(mutex_);
  if (done_.empty()) return {-1, gone_ ? ENODEV : EAGAIN};
  const Done done = done_.front();
  done_.pop_front();
  done.urb->status = done.status;
  *urb = done.urb;
  show_readiness();
  return {};
}

MockProbe::Answer MockProbe::request(const SetupPacket& setup) {
  std::unique_lock lock(mutex_);
  if (gone_) return {-1, ENODEV};
  own_request_ = next_id_++;
  Urb urb;
  urb.id = *own_request_;
  urb.setup = setup;
  lock.unlock();
  submit(std::move(urb));
  lock.lock();
  answered_.wait(lock, [&] { return !own_request_ || gone_; });
  own_request_.reset();
  return gone_ ? Answer{-1, ENODEV} : Answer{};
}

// ---- the device's threads

void MockProbe::complete(const UrbDone& done) {
  const std::lock_guard lock(mutex_);
  if (own_request_ == done.id) {
    own_request_.reset();
    answered_.notify_all();
    return;
  }
  const auto found = waiting_.find(done.id);
  if (found == waiting_.end()) return;
  usbdevfs_urb* urb = found->second.urb;
  auto* buffer = static_cast<std::byte*>(urb->buffer) + (found->second.endpoint == 0 ? sizeof(SetupPacket) : 0);
  std::copy(done.data.begin(), done.data.end(), buffer);
  urb->actual_length = static_cast<int>(done.size);
  waiting_.erase(found);
  done_.push_back({urb, errno_of(done.status)});
  show_readiness();
}

void MockProbe::show_readiness() {
  if (!gone_) tcflow(slave_, done_.empty() ? TCOOFF : TCOON);
}

}  // namespace sonoloft::test
