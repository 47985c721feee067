#pragma once
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "device_sim/port/usb/usb_device.h"
#include "device_sim/port/usbip/usbip_wire.h"
#include "protocol/port.h"

// URBs <-> [USB/IP SERVER] <-> TCP <-> vhci-hcd of a Linux host: a real device for everything there

struct pollfd;

namespace sonoloft::device_sim::usbip {

/// Exports the device to hosts on this machine, as bus id 1-1, to one of them at a time. `usbip attach -r 127.0.0.1
/// -b 1-1` plugs it in, `usbip detach` or the end of the connection pulls it out; without a device behind the port the
/// connection ends. It listens on 127.0.0.1 only, for USB/IP knows neither secrets nor users.
///
/// Threads: one, which never waits but in poll(): a port that hangs or a host that does not read holds up nobody but
/// its own transfers.
class UsbipServer {
 public:
  struct Made {
    std::unique_ptr<UsbipServer> value;
    std::string error;  ///< iff there is no value: cause and remedy
  };

  /// @param tcp_port  0: any that is free
  /// @pre   `port` outlives the server and is used by nobody else
  [[nodiscard]] static Made start(protocol::Port& port, const usb::UsbIdentity& identity, std::uint16_t tcp_port);
  ~UsbipServer();
  UsbipServer(const UsbipServer&) = delete;
  UsbipServer& operator=(const UsbipServer&) = delete;

  [[nodiscard]] std::uint16_t tcp_port() const { return tcp_port_; }

 private:
  struct Client {
    int socket;
    bool imported = false;
    std::vector<std::byte> received = {};
    // Guarded by mutex_.
    std::vector<std::byte> to_send = {};
    std::size_t sent = 0;     ///< of to_send
    std::size_t pending = 0;  ///< URBs
    bool closing = false;     ///< as soon as everything is sent
  };

  UsbipServer(protocol::Port& port, const usb::UsbIdentity& identity, int listener, int wake, std::uint16_t tcp_port);

  void serve();
  [[nodiscard]] bool gather(std::vector<pollfd>& polled);
  void accept_client();
  // False: the client is to be dropped.
  [[nodiscard]] bool serve(Client& client, int events);
  [[nodiscard]] bool receive(Client& client);
  [[nodiscard]] bool take_messages(Client& client);
  [[nodiscard]] bool obey(Client& client, Message& message);
  [[nodiscard]] bool send(Client& client);
  void import(Client& client, bool our_device);
  void submit(Client& client, usb::Urb urb);
  void unlink(Client& client, const UnlinkCommand& command);
  void drop(Client& client);

  void complete(const usb::UrbDone& done);

  const int listener_, wake_;
  const std::uint16_t tcp_port_;
  std::list<Client> clients_;  ///< the loop's

  std::mutex mutex_;            ///< held for moments; taken while the device's locks are held, never before them
  Client* importer_ = nullptr;  ///< gets the completions
  bool stopping_ = false;

  usb::UsbDevice device_;
  std::jthread thread_;
};

}  // namespace sonoloft::device_sim::usbip
