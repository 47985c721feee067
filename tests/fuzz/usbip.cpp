// What a host sends to the USB/IP server, and the transfers that this asks of the device. The first byte says whether
// the device was imported already.
#include <condition_variable>
#include <mutex>
#include <set>

#include "device_sim/port/usb/usb_device.h"
#include "device_sim/port/usbip/usbip_wire.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/prompt_port.h"

using namespace sonoloft;
using namespace sonoloft::device_sim;

namespace {

class Host {
 public:
  void obey(const usbip::Message& message) {
    if (const auto* submitted = std::get_if<usbip::SubmitCommand>(&message)) submit(submitted->urb);
    if (const auto* unlinked = std::get_if<usbip::UnlinkCommand>(&message)) unlink(unlinked->unlinked);
  }
  void wait_for_all() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return under_way_.empty(); });
  }

 private:
  void submit(const usb::Urb& urb) {
    {
      const std::lock_guard lock(mutex_);
      if (!under_way_.insert(urb.id).second) return;  // which one is meant could not be told
    }
    device_.submit(urb);
  }
  void unlink(std::uint64_t id) {
    const bool cancelled = device_.unlink(id);
    const std::lock_guard lock(mutex_);
    if (cancelled) fuzz::demand(under_way_.erase(id) == 1);
    fuzz::demand(!under_way_.contains(id));
  }
  void complete(const usb::UrbDone& done) {
    const std::lock_guard lock(mutex_);
    fuzz::demand(under_way_.erase(done.id) == 1);
    fuzz::demand(done.data.empty() || done.data.size() == done.size);
    std::vector<std::byte> reply;
    usbip::append_submit(done, reply);
    fuzz::demand(reply.size() == 48 + done.data.size());
    changed_.notify_all();
  }

  fuzz::PromptPort port_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::uint64_t> under_way_;
  usb::UsbDevice device_{port_, {"FUZZ-1", fuzz::kRecordLen}, [this](const usb::UrbDone& done) { complete(done); }};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  bool imported = input.number<std::uint8_t>() % 2 == 1;
  auto rest = input.rest();
  Host host;
  auto next = usbip::parse(rest, imported);
  while (next.kind == usbip::Parsed::Kind::message) {
    fuzz::demand(next.size > 0 && next.size <= rest.size());
    const auto* import = std::get_if<usbip::ImportRequest>(&*next.message);
    imported |= import != nullptr && import->our_device;
    host.obey(*next.message);
    rest = rest.subspan(next.size);
    next = usbip::parse(rest, imported);
  }
  host.wait_for_all();
  return 0;
}
