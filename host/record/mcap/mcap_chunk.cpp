#include "host/record/mcap/mcap_chunk.h"

#include <algorithm>

#include "host/record/mcap/mcap_encode.h"

namespace sonoloft::record::mcap {

void McapChunk::add(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns,
                    std::initializer_list<std::span<const std::byte>> parts) {
  std::uint64_t length = kMessageHeadLen;
  for (const auto& part : parts) length += part.size();
  start_ns_ = empty() ? time_ns : std::min(start_ns_, time_ns);
  end_ns_ = std::max(end_ns_, time_ns);
  index_[channel].emplace_back(time_ns, records_.size());
  append(records_, Opcode::message);
  append(records_, length);
  append(records_, channel);
  append(records_, sequence);
  append(records_, time_ns);
  append(records_, time_ns);  // published: nobody says when
  for (const auto& part : parts) records_ += text_of(part);
}

std::string McapChunk::encoded() const {
  std::string head;
  append(head, start_ns_);
  append(head, end_ns_);
  append(head, static_cast<std::uint64_t>(records_.size()));
  append(head, crc32(records_));
  append_text(head, "");  // not compressed
  append(head, static_cast<std::uint64_t>(records_.size()));
  std::string record;
  record.reserve(kRecordHeadLen + head.size() + records_.size());
  append(record, Opcode::chunk);
  append(record, static_cast<std::uint64_t>(head.size() + records_.size()));
  return record + head + records_;
}

}  // namespace sonoloft::record::mcap
