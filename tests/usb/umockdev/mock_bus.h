#pragma once
#include <umockdev.h>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "device_sim/port/usb/usb_device.h"
#include "protocol/port.h"

// libusb -> usbfs, as umockdev plays it -> [MOCK PROBE] -> UsbDevice -> firmware

struct usbdevfs_urb;

namespace sonoloft::test {

/// A USB bus of umockdev's. One at a time; libusb sees nothing else. @pre the process runs under umockdev's preload
class MockBus {
 public:
  MockBus();
  ~MockBus();
  MockBus(const MockBus&) = delete;
  MockBus& operator=(const MockBus&) = delete;

  [[nodiscard]] UMockdevTestbed* testbed() const { return testbed_; }
  [[nodiscard]] const std::string& root() const { return root_; }
  /// A file below /sys, as programs see it.
  void write_sys(const std::string& path, const std::string& text) const;

 private:
  UMockdevTestbed* testbed_;
  std::string root_;
};

/// A device of ours, plugged into the bus until unplug() or its end. The node of the device is a terminal, because
/// umockdev does not play poll(): libusb reaps when it may write, so output is held while there is nothing to reap.
/// Threads: those of the device, and umockdev's, which answers ioctls.
class MockProbe {
 public:
  /// @pre 1 <= address <= 99, another one for every probe of the bus; `bus` and `port` outlive it
  MockProbe(MockBus& bus, int address, protocol::Port& port, const device_sim::usb::UsbIdentity& identity);
  ~MockProbe();
  MockProbe(const MockProbe&) = delete;
  MockProbe& operator=(const MockProbe&) = delete;

  /// What waits ends as gone, the node hangs up, the hotplug monitor is told, the port is free. The probe itself stays,
  /// for libusb may still hold the node open.
  void unplug();
  /// Bulk transfers complete no more until the host does what helps, `times` times; control transfers do.
  enum class Cure { clear_halt, reset };
  void freeze_until(Cure cure, int times = 1);
  /// The stream's endpoint stalls until the host clears it.
  void halt();
  /// Nobody but root may open it.
  void forbid();

  [[nodiscard]] int clear_halts() const;
  [[nodiscard]] int resets() const;

 private:
  struct Answer {
    int result = 0;
    int error = 0;
  };
  struct Waiting {
    usbdevfs_urb* urb;
    std::uint8_t endpoint;
  };
  struct Done {
    usbdevfs_urb* urb;
    int status;
  };

  static gboolean on_ioctl(UMockdevIoctlBase* base, UMockdevIoctlClient* client, gpointer self);
  std::optional<Answer> ioctl(unsigned long request, void* argument);
  Answer submit(usbdevfs_urb* urb);
  Answer discard(usbdevfs_urb* urb);
  Answer reap(usbdevfs_urb** urb);
  Answer request(const device_sim::usb::SetupPacket& setup);
  void complete(const device_sim::usb::UrbDone& done);
  void thaw(Cure cure);
  void submit(device_sim::usb::Urb urb);
  void unlink(std::uint64_t id);
  void show_readiness();
  [[nodiscard]] std::string description(const device_sim::usb::Descriptors& descriptors,
                                        const std::string& serial) const;

  MockBus& bus_;
  const int address_;
  const std::string node_, syspath_;
  std::string terminal_;
  int master_ = -1, slave_ = -1;
  UMockdevIoctlBase* handler_;

  mutable std::mutex mutex_;
  std::condition_variable answered_;
  std::map<std::uint64_t, Waiting> waiting_;
  std::deque<Done> done_;
  std::optional<std::uint64_t> own_request_;
  std::uint64_t next_id_ = 1;
  int clear_halts_ = 0, resets_ = 0;
  bool gone_ = false;
  std::optional<Cure> frozen_until_;
  int cures_left_ = 0;

  std::mutex device_mutex_;  ///< before mutex_, never in a completion
  std::optional<device_sim::usb::UsbDevice> device_;
};

}  // namespace sonoloft::test
