#pragma once
#include <usbredirparser.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <variant>
#include <vector>

#include "device_sim/port/usb/completions.h"
#include "device_sim/port/usb/urb.h"
#include "device_sim/port/usb/usb_device.h"

namespace sonoloft::device_sim::usbredir {

/// One connection of a virtual machine: its packets become URBs, their completions packets. The parser is
/// libusbredirparser's. Threads: the caller's one.
class Guest {
 public:
  /// Takes the socket, which must not block. @pre `device` outlives it
  Guest(int socket, usb::UsbDevice& device);
  /// Pulls the device out: URBs under way are forgotten.
  ~Guest();
  Guest(const Guest&) = delete;
  Guest& operator=(const Guest&) = delete;

  [[nodiscard]] int socket() const { return socket_; }
  /// What poll() waits for. A guest that takes no answers is not listened to.
  [[nodiscard]] short awaited() const;
  /// Takes some of what has arrived. @return false: it has left, or makes no sense
  [[nodiscard]] bool receive();
  /// Sends what the socket takes. @return false: it has left, or the device has and the guest knows
  [[nodiscard]] bool send();
  void answer(const usb::Completion& done);

 private:
  struct Configuration {
    std::uint8_t number;
  };
  struct AltSetting {
    std::uint8_t interface, number;
  };
  using ControlPacket = usb_redir_control_packet_header;
  using BulkPacket = usb_redir_bulk_packet_header;
  struct NextEvent {};  ///< asked for by ourselves while the guest receives events
  using Question = std::variant<ControlPacket, BulkPacket, Configuration, AltSetting, NextEvent>;

  void set_callbacks();
  void set_data_callbacks();
  void refuse_the_rest();
  int read(std::uint8_t* data, int count);
  std::vector<std::byte> take(std::uint8_t* data, int len);
  void plug_in();
  void send_interface();
  void reset();
  void cancel(std::uint64_t id);
  void start_events(std::uint64_t id, std::uint8_t endpoint);
  void stop_events(std::uint64_t id, std::uint8_t endpoint);
  void await_event();
  void answer_event(const usb::Completion& done);
  void ask_control(std::uint64_t id, const ControlPacket& header, std::vector<std::byte> data);
  void ask_bulk(std::uint64_t id, const BulkPacket& header, std::vector<std::byte> data);
  void ask_device(std::uint64_t id, const Question& question, usb::SetupPacket setup);
  void ask(std::uint64_t id, const Question& question, usb::Urb urb, bool sensible);
  void reply(const Question& question, const usb::Completion& done, std::uint8_t status);

  struct Destroy {
    void operator()(usbredirparser* parser) const { usbredirparser_destroy(parser); }
  };

  const int socket_;
  usb::UsbDevice& device_;
  std::unique_ptr<usbredirparser, Destroy> parser_;
  std::map<std::uint64_t, Question> pending_;
  int budget_ = 0;  ///< bytes to read in this round
  bool receives_events_ = false;
  std::uint64_t events_sent_ = 0;
  bool nonsense_ = false, unplugged_ = false;
};

}  // namespace sonoloft::device_sim::usbredir
