#include "protocol/accept.h"

#include <cstring>

#include "protocol/crc32c.h"

namespace sonoloft::protocol {
namespace {

constexpr std::uint8_t kKnownIncompat = kIncompatMask;

bool version_fits(const RecordHeader& h, const Agreement& agreed) {
  return h.major == kVersion.major && h.minor <= agreed.minor && (h.incompat & ~kKnownIncompat) == 0 &&
         h.schema_hash == agreed.schema_hash;
}

bool lengths_agree(const RecordHeader& h, std::size_t transfer_len) {
  if (h.header_len < kHeaderLen || h.header_len > kMaxHeaderLen || h.header_len % kPayloadAlign != 0) return false;
  const std::uint64_t used = std::uint64_t{h.header_len} + h.payload_len + kTrailerLen;
  return h.total_len == transfer_len && h.total_len % kPacketDivisor != 0 && used <= h.total_len &&
         h.total_len - used < kMaxPadding;
}

bool session_fits(const RecordHeader& h, const Agreement& agreed) {
  return h.session_id == agreed.session_id && h.type == static_cast<std::uint16_t>(RecordType::slice) && h.stream == 0;
}

}  // namespace

const char* name(Reject reason) {
  static constexpr std::array<const char*, kRejectCount> kNames{"none",        "length",    "magic",    "header_crc",
                                                                "version",     "lengths",   "session",  "trailer",
                                                                "payload_crc", "alignment", "verifier", "meaning"};
  const auto i = static_cast<std::size_t>(reason);
  return i < kRejectCount ? kNames[i] : "none";
}

Reject Acceptor::accept(std::span<const std::byte> transfer, AcceptedSlice& accepted) {
  AcceptedSlice candidate;
  const Reject reason = check(transfer, candidate);
  ++counts_[static_cast<std::size_t>(reason)];
  if (reason == Reject::none) accepted = candidate;
  return reason;
}

Reject Acceptor::check(std::span<const std::byte> transfer, AcceptedSlice& accepted) const {
  if (transfer.size() < kHeaderLen + kTrailerLen || transfer.size() > agreement_.max_record) return Reject::length;
  RecordHeader& h = accepted.header;
  std::memcpy(&h, transfer.data(), kHeaderLen);
  if (h.magic != kMagic) return Reject::magic;
  if (crc32c(transfer.first(offsetof(RecordHeader, header_crc32c))) != h.header_crc32c) return Reject::header_crc;
  if (!version_fits(h, agreement_)) return Reject::version;
  if (!lengths_agree(h, transfer.size())) return Reject::lengths;
  if (!session_fits(h, agreement_)) return Reject::session;

  const std::size_t end = transfer.size() - kTrailerLen;
  RecordTrailer trailer;
  std::memcpy(&trailer, transfer.data() + end, kTrailerLen);
  if (trailer.end_magic != kEndMagic || trailer.seq_low != static_cast<std::uint32_t>(h.seq) || trailer.status != 0) {
    return Reject::trailer;
  }
  if (crc32c(transfer.subspan(kHeaderLen, end - kHeaderLen)) != trailer.payload_crc32c) return Reject::payload_crc;

  const auto payload = transfer.subspan(h.header_len, h.payload_len);
  if (reinterpret_cast<std::uintptr_t>(payload.data()) % kPayloadAlign != 0) return Reject::alignment;
  if (!decode_slice(payload, accepted.slice)) return Reject::verifier;
  accepted.slice.time_ns = h.t_device_ns;
  if (accepted.slice.has_mask() != ((h.incompat & kIncompatMask) != 0)) return Reject::meaning;
  return check_slice(accepted.slice, agreement_.limits) == SliceFault::none ? Reject::none : Reject::meaning;
}

}  // namespace sonoloft::protocol
