#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <type_traits>

#include "protocol/record.h"

// Requests and replies: what goes over the control endpoint. A request is RequestHeader | payload, its reply
// ReplyHeader | payload, all little-endian. A later minor version may append to a payload, never change it, so a longer
// payload than known is read as far as it is known.

namespace sonoloft::protocol {

inline constexpr std::size_t kMaxRequestLen = 4088;  ///< header and payload, of requests and of replies

enum class Command : std::uint16_t {
  get_info = 1,
  start = 2,
  stop = 3,
  get_stats = 4,
  time_sync = 5,
  heartbeat = 6,
  get_param = 7,
  set_param = 8,
  get_calibration = 9,
  set_calibration = 10,
  reset = 11,
  // Since 1.1.
  begin_blob = 12,
  get_blob = 13,
  keep_blob = 14,
};

/// The answer to a request, in the manner of GenCP.
enum class Status : std::uint16_t {
  ok = 0,
  not_implemented = 1,
  invalid_parameter = 2,
  busy = 3,         ///< ask again later
  wrong_state = 4,  ///< not while streaming (START, SET_CALIBRATION, BEGIN_BLOB); or not yet (KEEP_BLOB)
  pending = 5,      ///< not ready: PendingReply says when to send the same request again
  bad_request = 6,  ///< shorter than its header says or than its command needs
};

struct RequestHeader {
  std::uint16_t command;
  std::uint16_t payload_len;
  std::uint32_t request_id;  ///< the reply repeats it
};
struct ReplyHeader {
  std::uint16_t status;
  std::uint16_t payload_len;
  std::uint32_t request_id;
};

// What a device can do beyond answering GET_INFO; InfoReply::capabilities.
inline constexpr std::uint32_t kCapSlices = 1u << 0;       ///< stream 0 carries slices as contours
inline constexpr std::uint32_t kCapLossless = 1u << 1;     ///< StreamMode::lossless
inline constexpr std::uint32_t kCapCalibration = 1u << 2;  ///< keeps an ImageToProbe
inline constexpr std::uint32_t kCapEvents = 1u << 3;       ///< tells of events by itself
inline constexpr std::uint32_t kCapBlobs = 1u << 4;        ///< takes blobs
inline constexpr std::uint32_t kCapMasks = 1u << 5;        ///< may send masks instead of contours

struct InfoReply {
  std::uint8_t major, minor;
  std::uint16_t max_label;
  std::uint32_t schema_hash;
  std::uint32_t capabilities;
  std::uint32_t max_record;  ///< bytes
  std::uint32_t max_points;
  std::uint32_t max_contours;
  std::uint16_t ring_capacity;  ///< records
  std::uint16_t reserved;
  std::uint32_t clock_resolution_ns;
  char firmware_version[24];  ///< zero-terminated
  char serial[40];            ///< zero-terminated
  // Since 1.1; 0 to a reader of a 1.0 reply.
  std::uint32_t max_mask_runs;
  std::uint32_t max_mask_pixels;
  std::uint32_t max_blob;   ///< bytes
  std::uint32_t max_block;  ///< bytes of one transfer of a blob, all included; at least 128 where there are blobs
};
inline constexpr std::size_t kInfoReplyLen_1_0 = 96;

inline constexpr std::uint32_t kSliceStream = 1u << 0;  ///< bit of StartRequest::streams

enum class StreamMode : std::uint16_t {
  live = 0,      ///< a full ring drops its oldest record and counts it
  lossless = 1,  ///< a full ring is a fault: acquisition ends, what is in the ring is still sent
};

struct StartRequest {
  std::uint32_t session_id;   ///< chosen by the host, another one every time
  std::uint32_t streams;      ///< kSliceStream
  std::uint16_t mode;         ///< StreamMode
  std::uint8_t major, minor;  ///< what the host will read: the device's major, the lower minor of both
};

enum class DeviceState : std::uint16_t {
  idle = 0,
  streaming = 1,
  faulted = 2,  ///< acquisition ended by itself, DeviceFault says why; records wait in the ring until STOP
};
enum class DeviceFault : std::uint16_t {
  none = 0,
  ring_full = 1,  ///< lossless mode could not hold
  watchdog = 2,   ///< no request for too long: the device stopped by itself
};

inline constexpr std::uint16_t kStatsSourceEnded = 1;  ///< flag: nothing more will be acquired in this session

struct HeartbeatReply {
  std::uint16_t state;  ///< DeviceState
  std::uint16_t fault;  ///< DeviceFault
  std::uint16_t flags;  ///< kStatsSourceEnded
  std::uint16_t ring_used;
};

/// Of the session that runs, or of the last one. next_seq == sent + dropped + ring_used, always.
struct StatsReply {
  std::uint32_t session_id;
  std::uint16_t state;     ///< DeviceState
  std::uint16_t fault;     ///< DeviceFault
  std::uint64_t next_seq;  ///< records made
  std::uint64_t sent;      ///< records handed to the bus
  std::uint64_t dropped;   ///< records that were overwritten in a full ring, or discarded by STOP
  std::uint32_t refused;   ///< acquired slices that never became a record: over a limit or breaking a rule
  std::uint16_t flags;
  std::uint16_t ring_used;
};

struct TimeSyncRequest {
  std::uint64_t host_ns;
};
struct TimeSyncReply {
  std::uint64_t host_ns;    ///< as in the request
  std::uint64_t device_ns;  ///< the device's clock when it read the request
};

enum class Param : std::uint32_t {
  watchdog_ms = 1,  ///< 100..60000; the device stops after so long without a request
};
struct ParamMessage {  ///< request and reply; GET_PARAM ignores the value of the request
  std::uint32_t param;
  std::uint32_t reserved;
  std::int64_t value;
};

struct CalibrationMessage {  ///< reply of GET_CALIBRATION, request of SET_CALIBRATION
  std::uint32_t id;          ///< Slice::calibration_id refers to it; 0: the device has none
  std::uint32_t reserved;
  double image_to_probe[12];  ///< affine, 3 x 4, row after row: p_probe_mm = A * (x_px, y_px, 0, 1)
};

enum class BlobKind : std::uint32_t {
  firmware = 1,     ///< an image for the device to run
  calibration = 2,  ///< what its maker measured, beyond ImageToProbe
};
enum class BlobState : std::uint16_t {
  none = 0,       ///< nothing was begun, or it was given up
  receiving = 1,  ///< blocks are missing
  complete = 2,   ///< all bytes came, and their sum fits: KEEP_BLOB
  spoiled = 3,    ///< all bytes came, and their sum does not fit: begin again
  kept = 4,       ///< for good
};
struct BeginBlobRequest {
  std::uint32_t kind;  ///< BlobKind
  std::uint32_t len;   ///< bytes, at least 1
  std::uint32_t crc32c;
  std::uint32_t reserved;
};
struct BlobReply {     ///< of GET_BLOB
  std::uint32_t kind;  ///< of the blob begun last; 0: none
  std::uint32_t len;
  std::uint32_t received;  ///< bytes, from the first: where to go on
  std::uint16_t state;     ///< BlobState
  std::uint16_t reserved;
};

struct PendingReply {
  std::uint32_t retry_ms;
};

static_assert(sizeof(RequestHeader) == 8 && sizeof(ReplyHeader) == 8);
static_assert(sizeof(InfoReply) == 112 && offsetof(InfoReply, max_mask_runs) == kInfoReplyLen_1_0 &&
              offsetof(InfoReply, schema_hash) == 4 && offsetof(InfoReply, max_record) == 12);
static_assert(offsetof(InfoReply, ring_capacity) == 24 && offsetof(InfoReply, firmware_version) == 32 &&
              offsetof(InfoReply, serial) == 56);
static_assert(sizeof(StartRequest) == 12 && offsetof(StartRequest, mode) == 8 && offsetof(StartRequest, minor) == 11);
static_assert(sizeof(HeartbeatReply) == 8);
static_assert(sizeof(StatsReply) == 40 && offsetof(StatsReply, next_seq) == 8 && offsetof(StatsReply, refused) == 32);
static_assert(sizeof(TimeSyncRequest) == 8 && sizeof(TimeSyncReply) == 16);
static_assert(sizeof(ParamMessage) == 16 && offsetof(ParamMessage, value) == 8);
static_assert(sizeof(CalibrationMessage) == 104 && offsetof(CalibrationMessage, image_to_probe) == 8);
static_assert(sizeof(BeginBlobRequest) == 16 && sizeof(BlobReply) == 16 && offsetof(BlobReply, state) == 12);
static_assert(sizeof(PendingReply) == 4);

struct RequestView {
  Command command;
  std::uint32_t request_id;
  std::span<const std::byte> payload;
};
struct ReplyView {
  Status status;
  std::uint32_t request_id;
  std::span<const std::byte> payload;
};

/// @pre    8 + payload.size() <= min(out.size(), kMaxRequestLen)
/// @return the length written
std::size_t encode_request(Command command, std::uint32_t request_id, std::span<const std::byte> payload,
                           std::span<std::byte> out);
std::size_t encode_reply(Status status, std::uint32_t request_id, std::span<const std::byte> payload,
                         std::span<std::byte> out);

/// nullopt where the bytes are shorter than they say, or longer than a request may be. Unknown commands and statuses
/// come through as numbers.
[[nodiscard]] std::optional<RequestView> parse_request(std::span<const std::byte> bytes);
[[nodiscard]] std::optional<ReplyView> parse_reply(std::span<const std::byte> bytes);

/// The bytes of a payload struct, to send.
template <class T>
[[nodiscard]] std::span<const std::byte> bytes_of(const T& payload) {
  static_assert(std::is_trivially_copyable_v<T>);
  return std::as_bytes(std::span<const T, 1>(&payload, 1));
}

/// How long a payload was in the first version that had it.
template <class T>
inline constexpr std::size_t kFirstLen = sizeof(T);
template <>
inline constexpr std::size_t kFirstLen<InfoReply> = kInfoReplyLen_1_0;

/// A payload struct out of received bytes; false where there are too few. What an earlier version did not have is 0,
/// more than is known is a later version's.
template <class T>
[[nodiscard]] bool read_payload(std::span<const std::byte> bytes, T& payload) {
  static_assert(std::is_trivially_copyable_v<T>);
  if (bytes.size() < kFirstLen<T>) return false;
  payload = T{};
  std::memcpy(&payload, bytes.data(), bytes.size() < sizeof(T) ? bytes.size() : sizeof(T));
  return true;
}

/// The version that two ends speak: nullopt where the majors differ, else the lower minor.
[[nodiscard]] std::optional<Version> common_version(Version ours, Version theirs);

/// "not_implemented" and so on; "unknown status" for other numbers. Never fails.
[[nodiscard]] const char* name(Status status);

}  // namespace sonoloft::protocol
