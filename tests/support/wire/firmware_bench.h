#pragma once
#include <cstring>
#include <optional>

#include "device_sim/firmware/firmware.h"
#include "protocol/accept.h"
#include "protocol/command.h"
#include "tests/support/wire/wire_slices.h"

namespace sonoloft::test {

/// A firmware on a table: its memory, its clock in our hand, requests and records without a bus.
class FirmwareBench {
 public:
  explicit FirmwareBench(std::size_t records = 4, device_sim::BlobStore* blobs = nullptr)
      : memory_(records * device_sim::record_slot_len(kTestLimits)),
        record_(device_sim::record_slot_len(kTestLimits)),
        firmware(config(blobs), memory_.bytes()) {}

  static device_sim::FirmwareConfig config(device_sim::BlobStore* blobs = nullptr) {
    device_sim::FirmwareConfig config{kTestLimits, {"BENCH-1"}, {}};
    config.calibration = {kTestCalibrationId, 0, {0.2, 0, 0, 1, 0, 0.25, 0, 2, 0, 0, 1, 3}};
    config.blobs = blobs;
    return config;
  }

  protocol::ReplyView send(std::span<const std::byte> request) {
    const std::size_t len = firmware.handle_request(request, reply_, now_ms * 1'000'000);
    const auto reply = protocol::parse_reply(std::span<const std::byte>(reply_).first(len));
    return reply ? *reply : protocol::ReplyView{static_cast<protocol::Status>(0xFFFF), 0, {}};
  }
  protocol::Status tell(protocol::Command command, std::span<const std::byte> payload = {}) {
    return send(std::span(request_).first(protocol::encode_request(command, ++request_id, payload, request_))).status;
  }
  template <class Reply>
  std::optional<Reply> ask(protocol::Command command, std::span<const std::byte> payload = {}) {
    const auto reply =
        send(std::span(request_).first(protocol::encode_request(command, ++request_id, payload, request_)));
    Reply result;
    if (reply.status != protocol::Status::ok || !protocol::read_payload(reply.payload, result)) return std::nullopt;
    return result;
  }
  protocol::Status start(protocol::StreamMode mode = protocol::StreamMode::live, std::uint32_t session = 0x51DE0001,
                         std::uint8_t minor = protocol::kVersion.minor) {
    const protocol::StartRequest request{session, protocol::kSliceStream, static_cast<std::uint16_t>(mode),
                                         protocol::kVersion.major, minor};
    return tell(protocol::Command::start, protocol::bytes_of(request));
  }
  void acquire(std::uint32_t seed) {
    auto owned = make_wire_slice(seed);
    firmware.acquire(owned.view(), now_ms * 1'000'000);
  }
  /// The bytes of the next record; empty when there is none.
  std::span<const std::byte> take() { return record_.first(firmware.take_record(record_.bytes())); }
  std::optional<protocol::RecordHeader> take_header() {
    const auto record = take();
    protocol::RecordHeader header;
    if (!protocol::read_payload(record, header)) return std::nullopt;
    return header;
  }

 private:
  AlignedBytes memory_, record_;
  std::array<std::byte, protocol::kMaxRequestLen> request_{}, reply_{};

 public:
  std::uint64_t now_ms = 1000;
  std::uint32_t request_id = 0;
  device_sim::Firmware firmware;
};

}  // namespace sonoloft::test
