#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "device_sim/port/usb/completions.h"
#include "device_sim/port/usb/usb_device.h"
#include "protocol/port.h"

// URBs <-> [USB REDIRECTION SERVER] <-> TCP <-> QEMU, whose guest sees a device at an emulated controller

namespace sonoloft::device_sim::usbredir {

class Guest;

/// Redirects the device to a virtual machine on this computer, as a host with a real device does: `-chardev
/// socket,id=probe,host=127.0.0.1,port=4000,reconnect=1 -device usb-redir,chardev=probe`. To connect plugs it in, to
/// leave pulls it out; the next machine waits until the one before has left. Without a device behind the port it is
/// disconnected. It listens on 127.0.0.1 only, for the protocol knows neither secrets nor users.
///
/// Threads: one, which never waits but in poll(): a port that hangs or a machine that does not read holds up nobody.
/// Source: usbredir protocol 0.7, docs/usb-redirection-protocol.md of usbredir.
class UsbredirServer {
 public:
  struct Made {
    std::unique_ptr<UsbredirServer> value;
    std::string error;  ///< iff there is no value: cause and remedy
  };

  /// @param tcp_port  0: any that is free
  /// @pre   `port` outlives the server and is used by nobody else
  [[nodiscard]] static Made start(protocol::Port& port, const usb::UsbIdentity& identity, std::uint16_t tcp_port);
  ~UsbredirServer();
  UsbredirServer(const UsbredirServer&) = delete;
  UsbredirServer& operator=(const UsbredirServer&) = delete;

  [[nodiscard]] std::uint16_t tcp_port() const { return tcp_port_; }

 private:
  UsbredirServer(protocol::Port& port, const usb::UsbIdentity& identity, int listener, std::uint16_t tcp_port);

  void serve();
  void answer_guest();
  void serve_guest(int events);

  const int listener_;
  const std::uint16_t tcp_port_;

  std::atomic<bool> stopping_ = false;
  usb::Completions completions_;
  usb::UsbDevice device_;
  std::unique_ptr<Guest> guest_;  ///< the loop's
  std::jthread thread_;
};

}  // namespace sonoloft::device_sim::usbredir
