// What a virtual machine sends to the USB redirection server, in pieces, and the transfers that this asks of the
// device. The first byte says how long the pieces are.
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "device_sim/port/usbredir/guest.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/prompt_port.h"

using namespace sonoloft;
using namespace sonoloft::device_sim;

namespace {

/// What the server's loop does with a guest, until that has said all.
class Loop {
 public:
  /// @return false: the guest has left, or makes no sense
  bool hear(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = send(machine_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent > 0) bytes = bytes.subspan(static_cast<std::size_t>(sent));
      if (!guest_.receive() || !turn(0)) return false;
    }
    return true;
  }

  /// Hands over what is complete after so long, and takes what the guest says.
  bool turn(int wait_ms) {
    pollfd polled = {completions_.event(), POLLIN, 0};
    if (poll(&polled, 1, wait_ms) > 0)
      for (const usb::Completion& done : completions_.take()) guest_.answer(done);
    const bool stays = guest_.send();
    std::array<std::byte, 1 << 16> answer;
    while (recv(machine_, answer.data(), answer.size(), MSG_DONTWAIT) > 0) {
    }
    return stays;
  }

  ~Loop() { close(machine_); }

 private:
  static std::array<int, 2> connected() {
    std::array<int, 2> ends{};
    fuzz::demand(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends.data()) == 0);
    return ends;
  }

  const std::array<int, 2> ends_ = connected();
  const int machine_ = ends_[0];
  fuzz::PromptPort port_;
  usb::Completions completions_;
  usb::UsbDevice device_{port_, {"FUZZ-1", fuzz::kRecordLen}, [this](const usb::UrbDone& d) { completions_.add(d); }};
  usbredir::Guest guest_{ends_[1], device_};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const std::size_t piece = 1 + input.number<std::uint8_t>() * std::size_t{16};
  Loop loop;
  bool stays = true;
  while (stays && !input.empty()) stays = loop.hear(input.take(piece));
  for (int quiet = 0; stays && quiet < 2; ++quiet) stays = loop.turn(1);
  return 0;
}
