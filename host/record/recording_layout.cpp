#include "host/record/recording_layout.h"

#include <sonoloft/version.h>

#include <cstring>

#include "host/record/recording_bfbs_generated.h"
#include "host/record/slice_bfbs_generated.h"
#include "protocol/crc32c.h"
#include "protocol/record.h"
#include "protocol/slice_codec.h"

namespace sonoloft::record {
namespace {

constexpr const char* kFlatbuffer = "flatbuffer";

template <class BinarySchema>
mcap::Schema schema(Topic topic, const char* table) {
  return {static_cast<std::uint16_t>(topic), table, kFlatbuffer,
          std::string(reinterpret_cast<const char*>(BinarySchema::data()), BinarySchema::size())};
}

}  // namespace

const char* name(Topic topic) {
  switch (topic) {
    case Topic::slices:
      return "/slices";
    case Topic::transfers:
      return "/transfers";
    case Topic::requests:
      return "/requests";
    case Topic::stream:
      return "/stream";
    case Topic::events:
      return "/events";
  }
  return "";
}

mcap::Opening opening() {
  mcap::Opening opening{kProfile, "SonoLoft " SONOLOFT_VERSION, {}, {}};
  opening.schemas = {
      schema<protocol::wire::SliceBinarySchema>(Topic::slices, "sonoloft.protocol.wire.Slice"),
      schema<wire::ExchangeBinarySchema>(Topic::transfers, "sonoloft.record.wire.Transfer"),
      schema<wire::ExchangeBinarySchema>(Topic::requests, "sonoloft.record.wire.Exchange"),
      schema<wire::ExchangeBinarySchema>(Topic::stream, "sonoloft.record.wire.Stream"),
      schema<wire::ExchangeBinarySchema>(Topic::events, "sonoloft.record.wire.Event"),
  };
  for (const Topic topic : {Topic::slices, Topic::transfers, Topic::requests, Topic::stream, Topic::events}) {
    const auto id = static_cast<std::uint16_t>(topic);
    opening.channels.push_back({id, id, name(topic), kFlatbuffer});
  }
  return opening;
}

bool is_sound_slice(std::span<const std::byte> transfer) {
  using namespace protocol;
  if (transfer.size() < kSliceHeaderLen + kTrailerLen) return false;
  RecordHeader header;
  RecordTrailer trailer;
  const std::size_t end = transfer.size() - kTrailerLen;
  std::memcpy(&header, transfer.data(), sizeof header);
  std::memcpy(&trailer, transfer.data() + end, sizeof trailer);
  const bool fits = header.magic == kMagic && header.header_len == kSliceHeaderLen &&
                    header.type == static_cast<std::uint16_t>(RecordType::slice) &&
                    header.payload_len <= end - kSliceHeaderLen;
  if (!fits || crc32c(transfer.subspan(kSliceHeaderLen, end - kSliceHeaderLen)) != trailer.payload_crc32c) return false;
  Slice slice;
  return decode_slice(transfer.subspan(kSliceHeaderLen, header.payload_len), slice);
}

}  // namespace sonoloft::record
