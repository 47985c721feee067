#include "host/record/recorder.h"

#include <array>
#include <initializer_list>
#include <map>
#include <string>
#include <utility>

#include "host/record/mcap/mcap_chunk.h"
#include "host/record/mcap/mcap_writer.h"
#include "host/record/probe_facts.h"
#include "host/record/recording_generated.h"
#include "host/record/recording_layout.h"

namespace sonoloft::record {
namespace {

using mcap::McapChunk;
using Clock = std::chrono::steady_clock;
using Bytes = std::span<const std::byte>;

constexpr std::chrono::milliseconds kWritePeriod{250};
constexpr std::chrono::seconds kSyncPeriod{1};
constexpr std::size_t kChunkLen = 1u << 20;
constexpr std::size_t kMostWaiting = 64u << 20;

const std::uint8_t* octets(Bytes bytes) {
  return reinterpret_cast<const std::uint8_t*>(bytes.data());
}

Bytes built(const flatbuffers::FlatBufferBuilder& builder) {
  return std::as_bytes(std::span(builder.GetBufferPointer(), builder.GetSize()));
}

}  // namespace

struct Recorder::State {
  explicit State(std::unique_ptr<mcap::McapWriter> file) : writer(std::move(file)) {}

  const std::unique_ptr<mcap::McapWriter> writer;  ///< the writing thread's, then that of close()
  // Times rise even while somebody sets the clock.
  const std::chrono::nanoseconds epoch =
      std::chrono::system_clock::now().time_since_epoch() - Clock::now().time_since_epoch();

  mutable std::mutex mutex;  ///< guards what follows; held for moments, never while the disk works
  std::condition_variable to_writer, to_sync;
  McapChunk waiting;
  std::array<std::uint32_t, 6> sequence{};  ///< [Topic]
  ProbeFacts facts;
  std::map<std::string, std::string> metadata;  ///< to be written with the next chunk
  RecorderFigures figures;
  bool closing = false, closed = false;

  std::jthread writing, syncing;

  void add(Topic topic, std::initializer_list<Bytes> parts);
  void note_failure(const Error& error);
  void write_on();
  void flush(std::unique_lock<std::mutex>& lock);
  void count(const McapChunk& chunk);
  void sync_on();
};

/// @pre mutex is held
void Recorder::State::add(Topic topic, std::initializer_list<Bytes> parts) {
  std::size_t length = 0;
  for (const Bytes part : parts) length += part.size();
  if (closing || figures.failure || (!waiting.empty() && waiting.size() + length > kMostWaiting)) {
    ++figures.not_recorded;
    return;
  }
  const std::chrono::nanoseconds now = epoch + Clock::now().time_since_epoch();
  const auto channel = static_cast<std::uint16_t>(topic);
  waiting.add(channel, sequence[channel]++, static_cast<std::uint64_t>(now.count()), parts);
  if (waiting.size() >= kChunkLen) to_writer.notify_one();
}

void Recorder::State::note_failure(const Error& error) {
  if (!figures.failure) figures.failure = error;
}

void Recorder::State::write_on() {
  std::unique_lock lock(mutex);
  while (!closing) {
    to_writer.wait_for(lock, kWritePeriod, [&] { return closing || waiting.size() >= kChunkLen; });
    flush(lock);
  }
  flush(lock);  // of a recording that was closed before this thread began
}

/// Writes what waits. @pre `lock` holds the mutex, and does on return
void Recorder::State::flush(std::unique_lock<std::mutex>& lock) {
  const McapChunk chunk = std::exchange(waiting, {});
  const auto values = std::exchange(metadata, {});
  if (!figures.failure) {
    lock.unlock();
    Result<void> written;
    if (!values.empty()) written = writer->write_metadata("probe", values);
    if (written && !chunk.empty()) written = writer->write(chunk);
    lock.lock();
    if (!written) note_failure(written.error());
    figures.bytes = writer->size();
  }
  count(chunk);
}

/// What became of a chunk that was to be written. @pre mutex is held
void Recorder::State::count(const McapChunk& chunk) {
  for (const auto& [channel, entries] : chunk.index()) {
    const bool transfers =
        channel == static_cast<std::uint16_t>(Topic::slices) || channel == static_cast<std::uint16_t>(Topic::transfers);
    if (figures.failure)
      figures.not_recorded += entries.size();
    else if (transfers)
      figures.transfers += entries.size();
  }
}

void Recorder::State::sync_on() {
  std::unique_lock lock(mutex);
  while (!to_sync.wait_for(lock, kSyncPeriod, [&] { return closing; })) {
    lock.unlock();
    const auto synced = writer->sync();
    lock.lock();
    if (!synced) note_failure(synced.error());
  }
}

Result<std::shared_ptr<Recorder>> Recorder::create(const std::filesystem::path& path) {
  auto writer = mcap::McapWriter::create(path, opening());
  if (!writer) return tl::unexpected<Error>(writer.error());
  return std::shared_ptr<Recorder>(new Recorder(std::make_unique<State>(std::move(*writer))));
}

Recorder::Recorder(std::unique_ptr<State> state) : state_(std::move(state)) {
  state_->writing = std::jthread([this] { state_->write_on(); });
  state_->syncing = std::jthread([this] { state_->sync_on(); });
}

Recorder::~Recorder() {
  (void)close();
}

void Recorder::exchange(Bytes request, Bytes reply) {
  flatbuffers::FlatBufferBuilder builder;
  const auto sent = builder.CreateVector(octets(request), request.size());
  const auto received = reply.empty() ? 0 : builder.CreateVector(octets(reply), reply.size());
  builder.Finish(wire::CreateExchange(builder, sent, received));
  const auto asked = protocol::parse_request(request);
  const auto answered = protocol::parse_reply(reply);
  const std::lock_guard lock(state_->mutex);
  state_->add(Topic::requests, {built(builder)});
  if (!asked || !answered || answered->status != protocol::Status::ok) return;
  state_->facts.take(*asked, *answered);
  if (asked->command == protocol::Command::start) state_->metadata = state_->facts.text();
}

void Recorder::transfer(Bytes transfer) {
  if (is_sound_slice(transfer)) {
    const std::lock_guard lock(state_->mutex);
    return state_->add(Topic::slices, {transfer.subspan(kSliceHeaderLen), transfer.first(kSliceHeaderLen)});
  }
  flatbuffers::FlatBufferBuilder builder;
  builder.Finish(wire::CreateTransfer(builder, builder.CreateVector(octets(transfer), transfer.size())));
  const std::lock_guard lock(state_->mutex);
  state_->add(Topic::transfers, {built(builder)});
}

void Recorder::event(Bytes event) {
  flatbuffers::FlatBufferBuilder builder;
  builder.Finish(wire::CreateEvent(builder, builder.CreateVector(octets(event), event.size())));
  const std::lock_guard lock(state_->mutex);
  state_->add(Topic::events, {built(builder)});
}

void Recorder::stream(StreamMark mark) {
  const std::lock_guard lock(state_->mutex);
  flatbuffers::FlatBufferBuilder builder;
  builder.Finish(wire::CreateStream(builder, static_cast<wire::StreamEvent>(mark), state_->figures.not_recorded));
  state_->add(Topic::stream, {built(builder)});
}

RecorderFigures Recorder::figures() const {
  const std::lock_guard lock(state_->mutex);
  return state_->figures;
}

Result<void> Recorder::close() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->closing = true;
    state_->to_writer.notify_all();
    state_->to_sync.notify_all();
  }
  if (state_->writing.joinable()) state_->writing.join();
  if (state_->syncing.joinable()) state_->syncing.join();
  const std::lock_guard lock(state_->mutex);
  if (!state_->closed && !state_->figures.failure) {
    auto finished = state_->writer->finish();
    if (finished) finished = state_->writer->sync();
    if (!finished) state_->note_failure(finished.error());
    state_->figures.bytes = state_->writer->size();
  }
  state_->closed = true;
  if (state_->figures.failure) return tl::unexpected<Error>(*state_->figures.failure);
  return {};
}

}  // namespace sonoloft::record
