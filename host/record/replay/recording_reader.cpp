#include "host/record/replay/recording_reader.h"

#include <algorithm>

#include "host/record/recording_generated.h"
#include "host/record/recording_layout.h"

namespace sonoloft::record {
namespace {

std::span<const std::byte> bytes_of(const flatbuffers::Vector<std::uint8_t>* octets) {
  if (octets == nullptr) return {};
  return std::as_bytes(std::span(octets->data(), octets->size()));
}

/// The table at the root of a message; null where the bytes are none.
template <class Table>
const Table* table_of(std::span<const std::byte> message) {
  const auto* octets = reinterpret_cast<const std::uint8_t*>(message.data());
  flatbuffers::Verifier verifier(octets, message.size());
  return verifier.VerifyBuffer<Table>() ? flatbuffers::GetRoot<Table>(octets) : nullptr;
}

/// Room for so many bytes in a vector of blocks.
template <class Block>
std::span<std::byte> room_in(std::vector<Block>& blocks, std::size_t size) {
  blocks.resize(size / sizeof(Block) + 1);
  return std::as_writable_bytes(std::span(blocks)).first(size);
}

}  // namespace

Result<RecordingReader> RecordingReader::open(const std::filesystem::path& path) {
  auto file = mcap::McapReader::open(path);
  if (!file) return tl::unexpected<Error>(file.error());
  if ((*file)->profile() != kProfile)
    return (*file)->failure(ErrorCode::unsupported_format, "an MCAP file of profile \"" + (*file)->profile() +
                                                               "\": name a recording of `sonoloft record`");
  return RecordingReader(std::move(*file));
}

Result<std::optional<Recorded>> RecordingReader::next() {
  while (true) {
    const auto message = file_->next();
    if (!message) return tl::unexpected<Error>(message.error());
    if (!*message) return std::nullopt;
    auto recorded = decoded(**message);
    if (!recorded || *recorded) return recorded;
  }
}

Result<std::optional<Recorded>> RecordingReader::decoded(const mcap::Message& message) {
  const auto data = room_in(message_, message.data.size());
  std::copy(message.data.begin(), message.data.end(), data.begin());
  const auto copy_of = [this](std::span<const std::byte> bytes) {
    const auto copy = room_in(inner_, bytes.size());
    std::copy(bytes.begin(), bytes.end(), copy.begin());
    return copy;
  };
  if (message.topic == name(Topic::slices)) {
    if (data.size() < kSliceHeaderLen) return failure(ErrorCode::parse_failed, "a slice is too short");
    std::rotate(data.begin(), data.end() - kSliceHeaderLen, data.end());
    return Recorded{message.time_ns, RecordedTransfer{data}};
  }
  const auto damaged = [&] {
    return failure(ErrorCode::parse_failed, "a message of " + std::string(message.topic) + " cannot be read");
  };
  if (message.topic == name(Topic::transfers)) {
    const auto* table = table_of<wire::Transfer>(data);
    if (table == nullptr) return damaged();
    return Recorded{message.time_ns, RecordedTransfer{copy_of(bytes_of(table->bytes()))}};
  }
  if (message.topic == name(Topic::events)) {
    const auto* table = table_of<wire::Event>(data);
    if (table == nullptr) return damaged();
    return Recorded{message.time_ns, RecordedEvent{copy_of(bytes_of(table->bytes()))}};
  }
  if (message.topic == name(Topic::requests)) {
    const auto* table = table_of<wire::Exchange>(data);
    if (table == nullptr) return damaged();
    return Recorded{message.time_ns, RecordedExchange{bytes_of(table->request()), bytes_of(table->reply())}};
  }
  if (message.topic == name(Topic::stream)) {
    const auto* table = table_of<wire::Stream>(data);
    if (table == nullptr || table->event() > wire::StreamEvent_MAX) return damaged();
    return Recorded{message.time_ns, static_cast<StreamMark>(table->event())};
  }
  return std::nullopt;  // a later version's
}

}  // namespace sonoloft::record
