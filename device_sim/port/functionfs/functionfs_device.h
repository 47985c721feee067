#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "device_sim/port/functionfs/async_transfer.h"
#include "device_sim/port/usb/completions.h"
#include "device_sim/port/usb/usb_device.h"
#include "protocol/port.h"

// URBs <-> [FUNCTIONFS DEVICE] <-> Linux' gadget stack <-> a device controller <-> cable <-> any host

namespace sonoloft::device_sim::functionfs {

/// The device as a board with a USB device controller is one: a function of a Linux gadget, through a functionfs that
/// is mounted already. The kernel answers the standard requests; vendor requests, the endpoints and what the host does
/// to the cable come here. A request to the device is acknowledged when it has arrived, and its reply waits until it
/// was carried out. A suspended bus takes nothing, and nothing is lost. A port that halts stays silent until the host
/// configures the device anew.
///
/// Threads: one, which waits in poll(), and for a host that is in the middle of a control transfer.
/// Source: Linux, Documentation/usb/functionfs.rst.
class FunctionfsDevice {
 public:
  struct Made {
    std::unique_ptr<FunctionfsDevice> value;
    std::string error;  ///< iff there is no value: cause and remedy
  };

  /// Afterwards the gadget can be bound to its controller.
  /// @pre `port` outlives the device and is used by nobody else
  [[nodiscard]] static Made start(protocol::Port& port, const usb::UsbIdentity& identity, const std::string& directory);
  /// Pulls the device out.
  ~FunctionfsDevice();
  FunctionfsDevice(const FunctionfsDevice&) = delete;
  FunctionfsDevice& operator=(const FunctionfsDevice&) = delete;

  [[nodiscard]] const usb::Descriptors& descriptors() const { return device_.descriptors(); }

 private:
  /// Open files of a functionfs.
  struct Files {
    int control = -1, stream = -1, events = -1, blobs = -1;
  };
  /// An endpoint that the device model fills.
  struct In {
    const int file;
    const std::uint8_t endpoint;
    const std::size_t room;
    std::uint64_t urb;  ///< that gets the next message; 0: none
    AsyncTransfer writer;
  };

  FunctionfsDevice(protocol::Port& port, const usb::UsbIdentity& identity, Files files);
  static std::string open_files(const std::string& directory, const usb::Descriptors& descriptors, Files& files);
  static void close_files(const Files& files);

  void serve();
  void take_event();
  void disable();
  void ask(const usb::SetupPacket& setup);
  void ask_for_message(In& in);
  [[nodiscard]] bool take_block();
  void finish(usb::Completion& done);
  void finish(In& in, usb::Completion& done);
  void stall(const usb::SetupPacket& setup);

  const Files files_;
  std::atomic<bool> stopping_ = false;
  usb::Completions completions_;

  // The loop's.
  bool enabled_ = false;         ///< the host has configured the device
  usb::SetupPacket asked_{};     ///< the control transfer under way, if there is one
  std::uint64_t last_id_ = 0;    ///< of URBs
  std::uint64_t answer_id_ = 0;  ///< of the URB whose data the host waits for; 0: of none
  std::uint64_t block_id_ = 0;   ///< of the URB that takes a block; 0: of none
  In stream_, events_;
  AsyncTransfer blocks_;
  std::chrono::steady_clock::time_point next_read_{};  ///< where one has failed

  usb::UsbDevice device_;
  std::jthread thread_;
};

}  // namespace sonoloft::device_sim::functionfs
