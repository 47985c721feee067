#include "host/record/replay/replayed_probe.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

#include "protocol/crc32c.h"
#include "protocol/event.h"
#include "protocol/record.h"

namespace sonoloft::record {

using protocol::Command;
using protocol::RecordHeader;
using protocol::Status;

namespace {

std::uint32_t sum_of(std::span<const std::byte> header) {
  return protocol::crc32c(header.first(offsetof(RecordHeader, header_crc32c)));
}

}  // namespace

ReplayedProbe::ReplayedProbe(std::vector<std::byte> info, std::vector<std::byte> calibration)
    : info_(std::move(info)), calibration_(std::move(calibration)) {
  protocol::InfoReply known;
  if (!protocol::read_payload(info_, known)) return;
  known.capabilities |= protocol::kCapLossless;  // whatever it was, it can wait now
  known.capabilities &= ~protocol::kCapBlobs;
  std::memcpy(info_.data(), &known, std::min(info_.size(), sizeof known));
}

std::size_t ReplayedProbe::answer(std::span<const std::byte> bytes, std::span<std::byte> reply) {
  const auto request = protocol::parse_request(bytes);
  if (!request) return protocol::encode_reply(Status::bad_request, 0, {}, reply);
  const auto ok = [&](std::span<const std::byte> payload) {
    return protocol::encode_reply(Status::ok, request->request_id, payload, reply);
  };
  protocol::StartRequest start;
  protocol::HeartbeatReply beat{};
  switch (request->command) {
    case Command::get_info:
      return ok(info_);
    case Command::get_calibration:
      return ok(calibration_);
    case Command::start:
      if (!protocol::read_payload(request->payload, start)) break;
      session_id_ = start.session_id;
      ended_ = false;
      stats_ = {};
      stats_.session_id = start.session_id;
      return ok({});
    case Command::stop:
      session_id_.reset();
      return ok({});
    case Command::get_stats:
      return ok(protocol::bytes_of(stats_));
    case Command::heartbeat:
      if (session_id_) beat.state = static_cast<std::uint16_t>(protocol::DeviceState::streaming);
      if (ended_) beat.flags = protocol::kStatsSourceEnded;
      return ok(protocol::bytes_of(beat));
    default:
      break;
  }
  return protocol::encode_reply(Status::not_implemented, request->request_id, {}, reply);
}

void ReplayedProbe::adopt(std::span<std::byte> record, std::uint32_t recorded_id) {
  assert(session_id_);
  RecordHeader header;
  if (record.size() < sizeof header) return;
  std::memcpy(&header, record.data(), sizeof header);
  if (sum_of(record) != header.header_crc32c || header.session_id != recorded_id) return;
  header.session_id = *session_id_;
  std::memcpy(record.data(), &header, sizeof header);
  header.header_crc32c = sum_of(record);
  std::memcpy(record.data(), &header, sizeof header);
  stats_.next_seq = std::max(stats_.next_seq, header.seq + 1);
  stats_.dropped = header.device_dropped_total;
  stats_.sent = stats_.next_seq - stats_.dropped;
}

void ReplayedProbe::adopt_event(std::span<std::byte> bytes, std::uint32_t recorded_id) const {
  auto event = protocol::parse_event(bytes);
  if (!event || event->session_id != recorded_id) return;
  event->session_id = *session_id_;
  *event = protocol::seal_event(*event);
  std::memcpy(bytes.data(), &*event, sizeof *event);
}

}  // namespace sonoloft::record
