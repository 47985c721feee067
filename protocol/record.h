#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>

// What travels in one bulk transfer:  RecordHeader (64 bytes) | payload | padding | RecordTrailer (16 bytes).
// All numbers little-endian; the structs are laid out naturally and copied as they are, so the host of either end is
// little-endian too.

namespace sonoloft::protocol {

static_assert(std::endian::native == std::endian::little, "the wire structs are copied, not converted");

/// Major: what differs does not understand each other. Minor: the lower of both ends is spoken.
struct Version {
  std::uint8_t major, minor;
};
inline constexpr Version kVersion{1, 1};

inline constexpr std::uint32_t kMagic = 0x4F4E4F53;     ///< "SONO"
inline constexpr std::uint32_t kEndMagic = 0x54464F4C;  ///< "LOFT"
inline constexpr std::size_t kHeaderLen = 64;
inline constexpr std::size_t kTrailerLen = 16;
inline constexpr std::size_t kPayloadAlign = 16;    ///< of the payload, given a record that starts 64-byte aligned
inline constexpr std::size_t kRecordAlign = 64;     ///< of buffers that records are encoded into and accepted from
inline constexpr std::size_t kMaxPadding = 32;      ///< padding is shorter than this
inline constexpr std::size_t kMaxHeaderLen = 1024;  ///< of any later minor version
/// A record's length is never a multiple of this, so every bulk transfer ends with a short packet at any USB speed.
inline constexpr std::size_t kPacketDivisor = 64;

/// RecordHeader::incompat: the slice has a mask, and to a reader that does not know it, nothing. Since 1.1.
inline constexpr std::uint8_t kIncompatMask = 1, kMaskMinor = 1;

enum class RecordType : std::uint16_t { slice = 1, pose = 2, stats = 3, log = 4, event = 5 };

struct RecordHeader {
  std::uint32_t magic;
  std::uint16_t header_len;  ///< >= 64, a multiple of 16: a newer tail is skipped
  std::uint8_t major, minor;
  std::uint16_t type;     ///< RecordType
  std::uint16_t stream;   ///< bit number of the stream in StartRequest::streams
  std::uint8_t incompat;  ///< features that a reader must know: an unknown bit refuses the record
  std::uint8_t compat;    ///< features that a reader may ignore
  std::uint16_t flags;
  std::uint32_t total_len;  ///< header, payload, padding and trailer
  std::uint32_t payload_len;
  std::uint64_t seq;                   ///< per stream, from 0 at every START, without gaps at the sender
  std::uint64_t t_device_ns;           ///< middle of the acquisition
  std::uint32_t session_id;            ///< as given with START
  std::uint32_t device_dropped_total;  ///< records older than this one that the device dropped in this session
  std::uint32_t schema_hash;
  std::uint16_t ring_used, ring_capacity;  ///< records waiting behind this one; how many fit
  std::uint32_t reserved;                  ///< 0
  std::uint32_t header_crc32c;             ///< of the 60 bytes before
};

struct RecordTrailer {
  std::uint32_t payload_crc32c;  ///< of everything between the first 64 bytes and the trailer, padding included
  std::uint32_t seq_low;         ///< low half of RecordHeader::seq: a torn record shows
  std::uint32_t status;          ///< 0, else the device itself found the record spoiled while sending
  std::uint32_t end_magic;
};

static_assert(sizeof(RecordHeader) == kHeaderLen && alignof(RecordHeader) == 8);
static_assert(offsetof(RecordHeader, magic) == 0 && offsetof(RecordHeader, header_len) == 4);
static_assert(offsetof(RecordHeader, major) == 6 && offsetof(RecordHeader, minor) == 7);
static_assert(offsetof(RecordHeader, type) == 8 && offsetof(RecordHeader, stream) == 10);
static_assert(offsetof(RecordHeader, incompat) == 12 && offsetof(RecordHeader, compat) == 13);
static_assert(offsetof(RecordHeader, flags) == 14 && offsetof(RecordHeader, total_len) == 16);
static_assert(offsetof(RecordHeader, payload_len) == 20 && offsetof(RecordHeader, seq) == 24);
static_assert(offsetof(RecordHeader, t_device_ns) == 32 && offsetof(RecordHeader, session_id) == 40);
static_assert(offsetof(RecordHeader, device_dropped_total) == 44 && offsetof(RecordHeader, schema_hash) == 48);
static_assert(offsetof(RecordHeader, ring_used) == 52 && offsetof(RecordHeader, ring_capacity) == 54);
static_assert(offsetof(RecordHeader, reserved) == 56 && offsetof(RecordHeader, header_crc32c) == 60);
static_assert(sizeof(RecordTrailer) == kTrailerLen && alignof(RecordTrailer) == 4);
static_assert(offsetof(RecordTrailer, payload_crc32c) == 0 && offsetof(RecordTrailer, seq_low) == 4);
static_assert(offsetof(RecordTrailer, status) == 8 && offsetof(RecordTrailer, end_magic) == 12);

}  // namespace sonoloft::protocol
