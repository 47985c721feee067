#include "host/device/session.h"

#include <algorithm>
#include <cassert>
#include <cstdio>
#include <cstring>
#include <random>
#include <utility>

#include "core/slice/section.h"
#include "host/device/blob_sender.h"
#include "host/device/requester.h"
#include "host/device/run.h"
#include "protocol/accept.h"
#include "protocol/schema_hash.h"

namespace sonoloft::device {

using protocol::Command;

namespace {

// What we would allocate on a device's word.
constexpr std::uint32_t kMaxRecordLimit = 64u << 20, kMaxMaskRuns = 1u << 22, kMaxMaskPixels = 1u << 24;
constexpr std::size_t kMinBlock = 128, kMaxBlock = 1u << 16;

template <std::size_t N>
std::string text(const char (&field)[N]) {
  return std::string(field, strnlen(field, N));
}

tl::unexpected<Error> mismatch(const std::string& what, const std::string& have, const std::string& need,
                               const std::string& remedy) {
  return fail(ErrorCode::protocol_mismatch, what + ": have " + have + ", need " + need + ": " + remedy);
}

std::string text(protocol::Version v) {
  return std::to_string(v.major) + "." + std::to_string(v.minor);
}

std::string hex(std::uint32_t number) {
  char digits[11];
  std::snprintf(digits, sizeof digits, "0x%08x", number);
  return digits;
}

Result<DeviceInfo> agree(const protocol::InfoReply& reply) {
  const protocol::Version theirs{reply.major, reply.minor};
  const auto common = protocol::common_version(protocol::kVersion, theirs);
  if (!common) {
    return mismatch("protocol version of the device", text(theirs), std::to_string(protocol::kVersion.major) + ".x",
                    theirs.major < protocol::kVersion.major ? "update the device's firmware" : "update this program");
  }
  if (theirs.minor == protocol::kVersion.minor && reply.schema_hash != protocol::kSchemaHash) {
    return mismatch("schema of the device", hex(reply.schema_hash), hex(protocol::kSchemaHash),
                    "update whichever of the two is older");
  }
  if ((reply.capabilities & protocol::kCapSlices) == 0) {
    return mismatch("capabilities of the device", hex(reply.capabilities), hex(protocol::kCapSlices),
                    "this device sends no contours");
  }
  if (reply.max_record < protocol::kHeaderLen + protocol::kTrailerLen || reply.max_record > kMaxRecordLimit) {
    return mismatch("record length of the device", std::to_string(reply.max_record),
                    "80.." + std::to_string(kMaxRecordLimit), "update the device's firmware");
  }
  DeviceInfo info;
  info.version = *common;
  info.firmware_version = text(reply.firmware_version);
  info.serial = text(reply.serial);
  info.capabilities = reply.capabilities;
  info.schema_hash = reply.schema_hash;
  info.max_record = reply.max_record;
  info.max_points = std::min(reply.max_points, kMaxSlicePoints);
  info.max_contours = std::min(reply.max_contours, kMaxSliceContours);
  info.max_label = std::min<Label>(reply.max_label, kMaxLabel);
  info.ring_capacity = reply.ring_capacity;
  info.max_mask_runs = std::min(reply.max_mask_runs, kMaxMaskRuns);
  info.max_mask_pixels = std::min(reply.max_mask_pixels, kMaxMaskPixels);
  info.max_blob = (reply.capabilities & protocol::kCapBlobs) == 0 ? 0 : reply.max_blob;
  info.max_block = reply.max_block;
  return info;
}

Run::Plan make_plan(const DeviceInfo& info, const Calibration& calibration, const StreamOptions& options,
                    Callbacks callbacks) {
  const std::uint32_t session_id = std::random_device{}();
  Run::Plan plan;
  plan.agreement = {info.version.minor,
                    info.schema_hash,
                    session_id,
                    static_cast<std::uint32_t>(info.max_record),
                    {info.max_points, info.max_contours, info.max_label, info.max_mask_runs, info.max_mask_pixels}};
  plan.calibration = calibration;
  plan.queue_capacity = options.queue_capacity;
  plan.start = {session_id, protocol::kSliceStream, static_cast<std::uint16_t>(options.mode), info.version.major,
                info.version.minor};
  plan.callbacks = std::move(callbacks);
  return plan;
}

}  // namespace

Result<std::unique_ptr<Session>> Session::open(std::unique_ptr<Transport> transport) {
  auto requester = std::make_unique<Requester>(*transport);
  const auto greeting = greet(*requester);
  if (!greeting) return tl::unexpected(greeting.error());
  auto info = agree(greeting->info);
  if (!info) return tl::unexpected(info.error());
  auto calibration = make_calibration(greeting->calibration);
  if (!calibration) return tl::unexpected(calibration.error());
  return std::unique_ptr<Session>(
      new Session(std::move(transport), std::move(requester), *greeting, std::move(*info), *calibration));
}

Result<Session::Greeting> Session::greet(Requester& requester) {
  if (const auto stopped = requester.tell(Command::stop); !stopped) return tl::unexpected(stopped.error());
  const auto info = requester.ask<protocol::InfoReply>(Command::get_info);
  if (!info) return tl::unexpected(info.error());
  const auto calibration = requester.ask<protocol::CalibrationMessage>(Command::get_calibration);
  if (!calibration) return tl::unexpected(calibration.error());
  return Greeting{*info, *calibration};
}

Session::Session(std::unique_ptr<Transport> transport, std::unique_ptr<Requester> requester, const Greeting& greeting,
                 DeviceInfo info, Calibration calibration)
    : transport_(std::move(transport)),
      requester_(std::move(requester)),
      greeting_(greeting),
      info_(std::move(info)),
      calibration_(calibration) {}

Session::~Session() {
  assert(!on_dispatcher());
  stop();
}

std::shared_ptr<Run> Session::run() const {
  const std::lock_guard lock(state_mutex_);
  return run_;
}

bool Session::on_dispatcher() const {
  const auto run = this->run();
  return run && run->on_dispatcher();
}

Result<void> Session::start(const StreamOptions& options, Callbacks callbacks) {
  if (on_dispatcher()) {
    return fail(ErrorCode::wrong_state, "start() was called from a callback: call it from another thread");
  }
  if (options.queue_capacity == 0) {
    return fail(ErrorCode::invalid_argument, "queue_capacity is 0: give at least 1");
  }
  if (options.mode == StreamMode::lossless && (info_.capabilities & protocol::kCapLossless) == 0) {
    return mismatch("capabilities of the device", hex(info_.capabilities), hex(protocol::kCapLossless), "stream live");
  }
  const std::lock_guard life(life_mutex_);
  if (auto way = make_way(); !way) return way;
  const auto run =
      std::make_shared<Run>(*transport_, *requester_, make_plan(info_, calibration_, options, std::move(callbacks)));
  {
    const std::lock_guard lock(state_mutex_);
    run_ = run;  // before callbacks begin: they may call us
  }
  auto begun = run->begin();
  if (!begun) {
    const std::lock_guard lock(state_mutex_);
    run_.reset();
  }
  return begun;
}

Result<void> Session::make_way() {
  if (const auto running = run(); running && !running->stopping()) {
    return fail(ErrorCode::wrong_state, "the session is running: stop() it first");
  }
  finish_run();
  return find_again();
}

Result<void> Session::find_again() {
  if (!lost_) {
    const auto stopped = requester_->tell(Command::stop);
    if (stopped || stopped.error().code != ErrorCode::transport_closed) return stopped;
    lost_ = true;
  }
  if (auto reopened = transport_->reopen(); !reopened) return reopened;
  const auto greeting = greet(*requester_);
  if (!greeting) return tl::unexpected(greeting.error());
  if (std::memcmp(&*greeting, &greeting_, sizeof greeting_) != 0) {
    return fail(ErrorCode::protocol_mismatch,
                "the device came back with another firmware or calibration: open it anew");
  }
  lost_ = false;
  return {};
}

Result<void> Session::send_blob(BlobKind kind, std::span<const std::byte> bytes) {
  if (on_dispatcher()) {
    return fail(ErrorCode::wrong_state, "send_blob() was called from a callback: call it from another thread");
  }
  if (info_.max_blob == 0 || info_.max_block < kMinBlock || info_.max_block > kMaxBlock) {
    return fail(ErrorCode::not_available, "the device takes no blobs: see its maker's way to update it");
  }
  if (bytes.empty() || bytes.size() > info_.max_blob) {
    return fail(ErrorCode::invalid_argument, "a blob of " + std::to_string(bytes.size()) +
                                                 " bytes: the device takes 1 to " + std::to_string(info_.max_blob));
  }
  const std::lock_guard life(life_mutex_);
  if (auto way = make_way(); !way) return way;
  return device::send_blob(*transport_, *requester_, kind, bytes, info_.max_block);
}

void Session::stop() {
  if (const auto run = this->run(); run && run->on_dispatcher()) return run->request_stop();
  const std::lock_guard life(life_mutex_);
  finish_run();
}

void Session::finish_run() {
  const auto run = this->run();
  if (!run) return;
  run->request_stop();
  run->join();
  lost_ = run->lost();
  const std::lock_guard lock(state_mutex_);
  last_ = run->statistics();
  run_.reset();
}

Statistics Session::statistics() const {
  const std::lock_guard lock(state_mutex_);
  return run_ ? run_->statistics() : last_;
}

}  // namespace sonoloft::device
