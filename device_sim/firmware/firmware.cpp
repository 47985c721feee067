#include "device_sim/firmware/firmware.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include "protocol/record.h"
#include "protocol/schema_hash.h"
#include "sonoloft/version.h"

namespace sonoloft::device_sim {

using protocol::Command;
using protocol::DeviceFault;
using protocol::DeviceState;
using protocol::Status;
using protocol::StreamMode;

namespace {

constexpr std::int64_t kWatchdogMinMs = 100, kWatchdogMaxMs = 60000;
constexpr std::uint64_t kNsPerMs = 1'000'000;
constexpr std::uint32_t kBlobRetryMs = 50;

bool usable(const protocol::CalibrationMessage& message) {
  return message.id != 0 && std::all_of(std::begin(message.image_to_probe), std::end(message.image_to_probe),
                                        [](double number) { return std::isfinite(number); });
}

}  // namespace

std::size_t record_slot_len(const protocol::SliceLimits& limits) {
  const std::uint64_t len = protocol::max_record_len(limits);
  return static_cast<std::size_t>((len + protocol::kRecordAlign - 1) / protocol::kRecordAlign * protocol::kRecordAlign);
}

Firmware::Firmware(const FirmwareConfig& config, std::span<std::byte> ring_memory)
    : config_(config), ring_(ring_memory, record_slot_len(config.limits)), blobs_(config.blobs) {}

std::size_t Firmware::handle_request(std::span<const std::byte> request, std::span<std::byte> reply,
                                     std::uint64_t now_ns) {
  tick(now_ns);
  last_request_ns_ = now_ns;
  const auto view = protocol::parse_request(request);
  if (!view) return protocol::encode_reply(Status::bad_request, 0, {}, reply);
  const Answer a = answer(*view, now_ns);
  return protocol::encode_reply(a.status, view->request_id, a.payload, reply);
}

Firmware::Answer Firmware::answer(const protocol::RequestView& request, std::uint64_t now_ns) {
  switch (request.command) {
    case Command::get_info:
      return reply_with(info());
    case Command::start:
      return start(request.payload);
    case Command::stop:
      stop();
      return {Status::ok};
    case Command::get_stats:
      return reply_with(stats());
    case Command::time_sync:
      return time_sync(request.payload, now_ns);
    case Command::heartbeat:
      return reply_with(heartbeat());
    case Command::get_param:
      return param(request.payload, false);
    case Command::set_param:
      return param(request.payload, true);
    case Command::get_calibration:
      return reply_with(config_.calibration);
    case Command::set_calibration:
      return set_calibration(request.payload);
    case Command::reset:
      reset();
      return {Status::ok};
    case Command::begin_blob:
      return begin_blob(request.payload);
    case Command::get_blob:
      return reply_with(blobs_.status());
    case Command::keep_blob:
      return keep_blob();
  }
  return {Status::not_implemented};
}

template <class T>
Firmware::Answer Firmware::reply_with(const T& payload) {
  static_assert(sizeof(T) <= sizeof(answer_payload_));
  std::memcpy(answer_payload_.data(), &payload, sizeof(T));
  return {Status::ok, std::span<const std::byte>(answer_payload_).first(sizeof(T))};
}

Firmware::Answer Firmware::start(std::span<const std::byte> payload) {
  protocol::StartRequest wanted;
  if (!protocol::read_payload(payload, wanted)) return {Status::bad_request};
  if (state_ != DeviceState::idle) return {Status::wrong_state};
  const auto mode = static_cast<StreamMode>(wanted.mode);
  if (wanted.streams != protocol::kSliceStream || (mode != StreamMode::live && mode != StreamMode::lossless) ||
      wanted.major != protocol::kVersion.major || wanted.minor > protocol::kVersion.minor) {
    return {Status::invalid_parameter};
  }
  state_ = DeviceState::streaming;
  fault_ = DeviceFault::none;
  mode_ = mode;
  minor_ = wanted.minor;
  session_id_ = wanted.session_id;
  source_ended_ = false;
  next_seq_ = sent_ = dropped_ = 0;
  refused_ = 0;
  events_.begin(session_id_);
  blobs_.give_up();
  return {Status::ok};
}

Firmware::Answer Firmware::begin_blob(std::span<const std::byte> payload) {
  protocol::BeginBlobRequest wanted;
  if (!protocol::read_payload(payload, wanted)) return {Status::bad_request};
  if (state_ != DeviceState::idle) return {Status::wrong_state};
  return {blobs_.begin(wanted)};
}

Firmware::Answer Firmware::keep_blob() {
  const Status kept = blobs_.keep();
  if (kept != Status::pending) return {kept};
  Answer later = reply_with(protocol::PendingReply{kBlobRetryMs});
  later.status = Status::pending;
  return later;
}

Firmware::Answer Firmware::param(std::span<const std::byte> payload, bool set) {
  protocol::ParamMessage message;
  if (!protocol::read_payload(payload, message)) return {Status::bad_request};
  if (static_cast<protocol::Param>(message.param) != protocol::Param::watchdog_ms) return {Status::invalid_parameter};
  if (set) {
    if (message.value < kWatchdogMinMs || message.value > kWatchdogMaxMs) return {Status::invalid_parameter};
    watchdog_ms_ = message.value;
  }
  return reply_with(protocol::ParamMessage{message.param, 0, watchdog_ms_});
}

Firmware::Answer Firmware::set_calibration(std::span<const std::byte> payload) {
  protocol::CalibrationMessage message;
  if (!protocol::read_payload(payload, message)) return {Status::bad_request};
  // Records in the ring refer to the calibration they were taken with.
  if (state_ != DeviceState::idle) return {Status::wrong_state};
  if (!usable(message)) return {Status::invalid_parameter};
  config_.calibration = message;
  return {Status::ok};
}

Firmware::Answer Firmware::time_sync(std::span<const std::byte> payload, std::uint64_t now_ns) {
  protocol::TimeSyncRequest request;
  if (!protocol::read_payload(payload, request)) return {Status::bad_request};
  return reply_with(protocol::TimeSyncReply{request.host_ns, now_ns});
}

void Firmware::acquire(const AcquiredSlice& slice, std::uint64_t now_ns) {
  tick(now_ns);
  if (state_ != DeviceState::streaming) return;
  const bool readable = !slice.has_mask() || minor_ >= protocol::kMaskMinor;
  if (!readable || protocol::check_slice(slice, config_.limits) != protocol::SliceFault::none) {
    ++refused_;
    return;
  }
  if (ring_.full() && mode_ == StreamMode::lossless) {
    ++refused_;
    state_ = DeviceState::faulted;
    return fault(DeviceFault::ring_full, now_ns);
  }
  if (ring_.full()) {
    ring_.pop();
    ++dropped_;
  }
  // A slice within the limits fits into a slot: the slots were made for them.
  [[maybe_unused]] const std::size_t len =
      protocol::encode_slice(slice, {next_seq_, session_id_, minor_}, ring_.free_slot());
  assert(len != 0);
  ring_.push();
  ++next_seq_;
}

std::size_t Firmware::take_record(std::span<std::byte> out) {
  if (ring_.empty()) return 0;
  const std::span<std::byte> slot = ring_.oldest();
  protocol::RecordHeader header;
  std::memcpy(&header, slot.data(), sizeof header);
  // Only records older than this one have been dropped so far: a full ring drops its oldest.
  protocol::seal_record(slot.first(header.total_len), static_cast<std::uint32_t>(dropped_),
                        static_cast<std::uint16_t>(ring_.used() - 1), ring_.capacity());
  assert(out.size() >= header.total_len);
  std::memcpy(out.data(), slot.data(), header.total_len);
  ring_.pop();
  ++sent_;
  return header.total_len;
}

void Firmware::tick(std::uint64_t now_ns) {
  if (state_ == DeviceState::idle) return;
  if (now_ns < last_request_ns_ + static_cast<std::uint64_t>(watchdog_ms_) * kNsPerMs) return;
  stop();
  fault(DeviceFault::watchdog, now_ns);
}

void Firmware::end_of_source(std::uint64_t now_ns) {
  if (state_ != DeviceState::streaming || source_ended_) return;
  source_ended_ = true;
  tell(protocol::EventKind::source_ended, now_ns);
}

void Firmware::button(std::uint16_t number, bool pressed, std::uint64_t now_ns) {
  if (state_ != DeviceState::idle) tell(protocol::EventKind::button, now_ns, number, pressed ? 1 : 0);
}

void Firmware::fault(DeviceFault fault, std::uint64_t now_ns) {
  fault_ = fault;
  tell(protocol::EventKind::state, now_ns);
}

void Firmware::tell(protocol::EventKind kind, std::uint64_t now_ns, std::uint16_t number, std::uint32_t value) {
  events_.push({0, static_cast<std::uint16_t>(kind), number, value, 0, now_ns, 0, 0});
}

void Firmware::stop() {
  dropped_ += ring_.used();
  ring_.clear();
  events_.clear();
  state_ = DeviceState::idle;
}

void Firmware::reset() {
  stop();
  fault_ = DeviceFault::none;
  watchdog_ms_ = kWatchdogMs;
  session_id_ = 0;
  source_ended_ = false;
  next_seq_ = sent_ = dropped_ = 0;
  refused_ = 0;
  blobs_.give_up();
}

protocol::InfoReply Firmware::info() const {
  protocol::InfoReply info{};
  info.major = protocol::kVersion.major;
  info.minor = protocol::kVersion.minor;
  info.max_label = config_.limits.max_label;
  info.schema_hash = protocol::kSchemaHash;
  info.capabilities = protocol::kCapSlices | protocol::kCapLossless | protocol::kCapCalibration | protocol::kCapEvents |
                      protocol::kCapMasks | (config_.blobs == nullptr ? 0 : protocol::kCapBlobs);
  info.max_record = static_cast<std::uint32_t>(ring_.slot_len());
  info.max_points = config_.limits.max_points;
  info.max_contours = config_.limits.max_contours;
  info.max_mask_runs = config_.limits.max_mask_runs;
  info.max_mask_pixels = config_.limits.max_mask_pixels;
  info.max_blob = blobs_.max_blob();
  info.max_block = BlobReceiver::kMaxBlock;
  info.ring_capacity = ring_.capacity();
  info.clock_resolution_ns = 1;
  static_assert(sizeof(SONOLOFT_VERSION) <= sizeof(info.firmware_version));
  std::memcpy(info.firmware_version, SONOLOFT_VERSION, sizeof(SONOLOFT_VERSION));
  std::copy(config_.serial.begin(), config_.serial.end(), info.serial);
  return info;
}

protocol::StatsReply Firmware::stats() const {
  return {session_id_,
          static_cast<std::uint16_t>(state_),
          static_cast<std::uint16_t>(fault_),
          next_seq_,
          sent_,
          dropped_,
          refused_,
          source_ended_ ? protocol::kStatsSourceEnded : std::uint16_t{0},
          ring_.used()};
}

protocol::HeartbeatReply Firmware::heartbeat() const {
  const protocol::StatsReply s = stats();
  return {s.state, s.fault, s.flags, s.ring_used};
}

}  // namespace sonoloft::device_sim
