// A transport that is written in C.
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host/capi/capi_probe.h"
#include "host/capi/capi_status.h"

using namespace sonoloft;
using namespace sonoloft::capi;

namespace {

struct alignas(64) Block {
  std::byte bytes[64];
};

}  // namespace

struct sonoloft_sink {
  device::TransferSink* sink = nullptr;
  std::vector<Block> aligned;  ///< room for one record
};

namespace {

Result<void> result_of(sonoloft_status status) {
  if (status == SONOLOFT_OK) return {};
  const auto code = status == SONOLOFT_OUT_OF_MEMORY ? ErrorCode::io_failed : static_cast<ErrorCode>(status);
  return fail(code, std::string("the transport answered ") + sonoloft_status_name(status) + ": check it");
}

class CTransport final : public device::Transport {
 public:
  explicit CTransport(const sonoloft_transport& functions) : functions_(functions) {}
  ~CTransport() override {
    if (functions_.close) functions_.close(functions_.user);
  }

  Result<std::size_t> control(std::span<const std::byte> request, std::span<std::byte> reply,
                              std::chrono::milliseconds timeout) override {
    std::size_t length = 0;
    const auto done = result_of(functions_.control(functions_.user, request.data(), request.size(), reply.data(),
                                                   reply.size(), &length, static_cast<std::uint32_t>(timeout.count())));
    if (!done) return tl::unexpected<Error>(done.error());
    if (length > reply.size()) return fail(ErrorCode::io_failed, "the transport wrote beyond a reply's room: check it");
    return length;
  }
  Result<void> start_stream(device::TransferSink& sink, std::size_t max_record) override {
    sink_.sink = &sink;
    sink_.aligned.resize((max_record + sizeof(Block) - 1) / sizeof(Block));
    return result_of(functions_.start_stream(functions_.user, &sink_, max_record));
  }
  void stop_stream() override { functions_.stop_stream(functions_.user); }
  Result<void> send_block(std::span<const std::byte> block, std::chrono::milliseconds timeout) override {
    if (!functions_.send_block) return Transport::send_block(block, timeout);
    return result_of(functions_.send_block(functions_.user, block.data(), block.size(),
                                           static_cast<std::uint32_t>(timeout.count())));
  }

 private:
  const sonoloft_transport functions_;
  sonoloft_sink sink_;
};

}  // namespace

sonoloft_status sonoloft_open_transport(const sonoloft_transport* transport, sonoloft_probe** probe,
                                        sonoloft_error* error) {
  return guarded(error, [&]() -> Result<void> {
    const auto functions = read_sized(transport);
    if (!functions) return tl::unexpected<Error>(functions.error());
    if (auto given = need(functions->control, functions->start_stream, functions->stop_stream, probe); !given)
      return given;
    *probe = new sonoloft_probe{std::make_unique<CTransport>(*functions)};
    return {};
  });
}

void sonoloft_sink_transfer(sonoloft_sink* sink, const void* bytes, size_t length) {
  if (reinterpret_cast<std::uintptr_t>(bytes) % alignof(Block) != 0) {
    length = std::min(length, sizeof(Block) * sink->aligned.size());
    bytes = std::memcpy(sink->aligned.data(), bytes, length);
  }
  sink->sink->on_transfer({static_cast<const std::byte*>(bytes), length});
}

void sonoloft_sink_event(sonoloft_sink* sink, const void* bytes, size_t length) {
  sink->sink->on_event({static_cast<const std::byte*>(bytes), length});
}

void sonoloft_sink_gone(sonoloft_sink* sink) {
  sink->sink->on_gone();
}
