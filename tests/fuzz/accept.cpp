// The record accept chain, and what a session makes of what it accepts. The first byte says how much of the record is
// put right, so that the later checks are met.
#include "protocol/accept.h"

#include <algorithm>
#include <array>

#include "core/slice/section.h"
#include "host/device/calibration.h"
#include "protocol/crc32c.h"
#include "protocol/schema_hash.h"
#include "tests/fuzz/input.h"

using namespace sonoloft;
using namespace sonoloft::protocol;

namespace {

constexpr std::size_t kLongest = 1 << 14;
constexpr SliceLimits kLimits{512, 16, 9, 256, 1 << 12};
alignas(kRecordAlign) std::array<std::byte, kLongest> record, again;

void put_right(std::span<std::byte> bytes, std::uint8_t how) {
  if (bytes.size() < kHeaderLen + kTrailerLen) return;
  RecordHeader header;
  RecordTrailer trailer;
  const auto tail = bytes.last(kTrailerLen);
  std::memcpy(&header, bytes.data(), kHeaderLen);
  std::memcpy(&trailer, tail.data(), kTrailerLen);
  header.magic = kMagic;
  if (how & 2) {
    header.major = kVersion.major;
    header.minor = 0;
    header.incompat = how & 8 ? kIncompatMask : std::uint8_t{0};
    header.schema_hash = kSchemaHash;
    header.session_id = 7;
    header.type = 1;
    header.stream = 0;
  }
  if (how & 4) {
    header.header_len = kHeaderLen;
    header.total_len = static_cast<std::uint32_t>(bytes.size());
    const std::uint32_t between = header.total_len - kHeaderLen - kTrailerLen;
    header.payload_len = between - std::min<std::uint32_t>(header.payload_len % kMaxPadding, between);
  }
  trailer.seq_low = static_cast<std::uint32_t>(header.seq);
  trailer.status = 0;
  trailer.end_magic = kEndMagic;
  std::memcpy(bytes.data(), &header, kHeaderLen);
  header.header_crc32c = crc32c(bytes.first(60));
  std::memcpy(bytes.data(), &header, kHeaderLen);
  trailer.payload_crc32c = crc32c(bytes.subspan(kHeaderLen, bytes.size() - kHeaderLen - kTrailerLen));
  std::memcpy(tail.data(), &trailer, kTrailerLen);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const auto how = input.number<std::uint8_t>();
  const auto bytes = input.take(kLongest);
  std::copy(bytes.begin(), bytes.end(), record.begin());
  const auto transfer = std::span(record).first(bytes.size());
  if (how & 1) put_right(transfer, how);

  Acceptor acceptor({kVersion.minor, kSchemaHash, 7, kLongest, kLimits});
  AcceptedSlice accepted;
  const Reject reason = acceptor.accept(transfer, accepted);
  fuzz::demand(acceptor.count(reason) == 1);
  if (reason != Reject::none) return 0;
  // What was accepted means something, and survives another journey.
  fuzz::demand(check_slice(accepted.slice, kLimits) == SliceFault::none);
  const std::size_t len = encode_slice(accepted.slice, {accepted.header.seq, 7, 0}, again);
  if (len == 0) return 0;  // the field of view may be longer than this buffer
  seal_record(std::span(again).first(len), 0, 0, 1);
  AcceptedSlice second;
  fuzz::demand(acceptor.accept(std::span(again).first(len), second) == Reject::none);
  fuzz::demand(second.slice.points.size() == accepted.slice.points.size());
  fuzz::demand(second.slice.mask_runs.size() == accepted.slice.mask_runs.size());
  device::Calibration calibration;
  calibration.id = second.slice.calibration_id;
  (void)make_section(device::to_delivered(second.slice, 0, calibration, {}).slice);
  return 0;
}
