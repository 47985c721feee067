// The host opening a device that answers anything at all. The first byte says whether replies at least look like some.
#include "host/device/session.h"
#include "tests/fuzz/input.h"

using namespace sonoloft;

namespace {

class FuzzedTransport final : public device::Transport {
 public:
  explicit FuzzedTransport(fuzz::Input input) : input_(input), plausible_(input_.number<std::uint8_t>() % 2 == 1) {}

  Result<std::size_t> control(std::span<const std::byte> request, std::span<std::byte> reply,
                              std::chrono::milliseconds) override {
    if (input_.empty()) return fail(ErrorCode::transport_closed, "the input is used up");
    const auto bytes = input_.take(input_.number<std::uint8_t>());
    std::copy(bytes.begin(), bytes.end(), reply.begin());
    if (!plausible_) return bytes.size();
    protocol::RequestHeader asked;
    (void)protocol::read_payload(request, asked);
    const std::size_t payload = bytes.size() < sizeof asked ? 0 : bytes.size() - sizeof asked;
    auto status = static_cast<protocol::Status>(input_.number<std::uint8_t>() / 32);
    // These two make the host wait.
    if (status == protocol::Status::busy || status == protocol::Status::pending) status = protocol::Status::ok;
    const protocol::ReplyHeader header{static_cast<std::uint16_t>(status), static_cast<std::uint16_t>(payload),
                                       asked.request_id};
    std::memcpy(reply.data(), &header, sizeof header);
    return sizeof header + payload;
  }
  Result<void> start_stream(device::TransferSink&, std::size_t) override { return {}; }
  void stop_stream() override {}

 private:
  fuzz::Input input_;
  bool plausible_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto session = device::Session::open(std::make_unique<FuzzedTransport>(fuzz::Input(data, size)));
  if (!session) {
    fuzz::demand(!session.error().message.empty());
    return 0;
  }
  fuzz::demand((*session)->info().max_record <= 64u << 20);
  fuzz::demand((*session)->calibration().image_to_probe.matrix().allFinite());
  return 0;
}
