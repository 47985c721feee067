// A transport of your own. This one reaches its device through another one and measures what passes; one over a network
// or a driver of yours has the same members. The contract of each is in host/device/transport.h.
#include <atomic>
#include <cstdio>
#include <optional>
#include <semaphore>

#include "host/scan/scan_session.h"
#include "host/simulated/simulated_probe.h"

using namespace sonoloft;

namespace {

struct Traffic {
  std::atomic<std::size_t> requests = 0, transfers = 0, bytes = 0;
};

class MeteredTransport final : public device::Transport, private device::TransferSink {
 public:
  MeteredTransport(std::unique_ptr<device::Transport> inner, std::shared_ptr<Traffic> traffic)
      : inner_(std::move(inner)), traffic_(std::move(traffic)) {}

  Result<std::size_t> control(std::span<const std::byte> request, std::span<std::byte> reply,
                              std::chrono::milliseconds timeout) override {
    ++traffic_->requests;
    return inner_->control(request, reply, timeout);
  }
  Result<void> start_stream(device::TransferSink& sink, std::size_t max_record) override {
    sink_ = &sink;
    return inner_->start_stream(*this, max_record);
  }
  void stop_stream() override { inner_->stop_stream(); }
  void restart_stream() override { inner_->restart_stream(); }
  void reset_stream() override { inner_->reset_stream(); }
  Result<void> send_block(std::span<const std::byte> block, std::chrono::milliseconds timeout) override {
    return inner_->send_block(block, timeout);
  }
  Result<void> reopen() override { return inner_->reopen(); }

 private:
  void on_transfer(std::span<const std::byte> transfer) override {
    ++traffic_->transfers;
    traffic_->bytes += transfer.size();
    sink_->on_transfer(transfer);
  }
  void on_event(std::span<const std::byte> event) override { sink_->on_event(event); }
  void on_gone() override { sink_->on_gone(); }

  std::unique_ptr<device::Transport> inner_;
  std::shared_ptr<Traffic> traffic_;
  device::TransferSink* sink_ = nullptr;
};

Result<void> scan_through(std::unique_ptr<device::Transport> transport) {
  ScanOptions options;
  options.reconstructor.box = {Eigen::Vector3d::Constant(-300), Eigen::Vector3d::Constant(300)};
  options.reconstructor.spacing_mm = 8;
  options.stream.mode = device::StreamMode::lossless;
  const auto scan = ScanSession::open(std::move(transport), options);
  if (!scan) return tl::unexpected<Error>(scan.error());
  std::counting_semaphore<> end(0);
  ScanCallbacks callbacks;
  callbacks.on_event = [&end](const ScanEvent& event) {
    std::printf("%s\n", event.message.c_str());
    if (ends_run(event.kind)) end.release();
  };
  if (auto started = (*scan)->start(callbacks); !started) return started;
  end.acquire();
  return {};
}

}  // namespace

int main() {
  auto probe = open_simulated_probe({.slices = 10, .rate_hz = 0});
  if (!probe) return std::fprintf(stderr, "%s\n", probe.error().message.c_str()), 1;
  const auto traffic = std::make_shared<Traffic>();
  const auto done = scan_through(std::make_unique<MeteredTransport>(std::move(*probe), traffic));
  if (!done) return std::fprintf(stderr, "%s\n", done.error().message.c_str()), 1;
  std::printf("%zu transfers, %zu bytes\n", traffic->transfers.load(), traffic->bytes.load());
}
