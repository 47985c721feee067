#include "host/record/recording_transport.h"

#include "protocol/command.h"

namespace sonoloft::record {

using protocol::Command;

void RecordingTransport::record(std::shared_ptr<Recorder> recorder) {
  const std::lock_guard lock(mutex_);
  if (recorder_ && streaming_) recorder_->stream(StreamMark::closed);
  recorder_.swap(recorder);  // the one before may end with this call, after the lock
  if (!recorder_) return;
  write(info_);
  write(calibration_);
  if (streaming_) recorder_->stream(StreamMark::opened);
  if (streaming_) write(start_);
}

Result<std::size_t> RecordingTransport::control(std::span<const std::byte> request, std::span<std::byte> reply,
                                                std::chrono::milliseconds timeout) {
  auto size = transport_->control(request, reply, timeout);
  const auto came = size ? std::span<const std::byte>(reply).first(*size) : std::span<const std::byte>();
  const std::lock_guard lock(mutex_);
  keep(request, came);
  if (recorder_) recorder_->exchange(request, came);
  return size;
}

void RecordingTransport::keep(std::span<const std::byte> request, std::span<const std::byte> reply) {
  const auto asked = protocol::parse_request(request);
  const auto answered = protocol::parse_reply(reply);
  if (!asked || !answered || answered->status != protocol::Status::ok) return;
  const Exchange exchange{{request.begin(), request.end()}, {reply.begin(), reply.end()}};
  if (asked->command == Command::get_info) info_ = exchange;
  if (asked->command == Command::get_calibration) calibration_ = exchange;
  if (asked->command == Command::start) start_ = exchange;
}

void RecordingTransport::write(const Exchange& kept) {
  if (!kept.request.empty()) recorder_->exchange(kept.request, kept.reply);
}

Result<void> RecordingTransport::start_stream(device::TransferSink& sink, std::size_t max_record) {
  sink_ = &sink;
  open_stream();
  auto started = transport_->start_stream(*this, max_record);
  if (!started) end_stream(StreamMark::closed);
  return started;
}

void RecordingTransport::stop_stream() {
  transport_->stop_stream();
  end_stream(StreamMark::closed);
  sink_ = nullptr;
}

void RecordingTransport::open_stream() {
  const std::lock_guard lock(mutex_);
  streaming_ = true;
  start_ = {};
  if (recorder_) recorder_->stream(StreamMark::opened);
}

/// Once for each stream: one that is gone is not closed, too.
void RecordingTransport::end_stream(StreamMark mark) {
  const std::lock_guard lock(mutex_);
  if (std::exchange(streaming_, false) && recorder_) recorder_->stream(mark);
}

void RecordingTransport::on_transfer(std::span<const std::byte> transfer) {
  {
    const std::lock_guard lock(mutex_);
    if (recorder_) recorder_->transfer(transfer);
  }
  sink_->on_transfer(transfer);
}

void RecordingTransport::on_event(std::span<const std::byte> event) {
  {
    const std::lock_guard lock(mutex_);
    if (recorder_) recorder_->event(event);
  }
  sink_->on_event(event);
}

void RecordingTransport::on_gone() {
  end_stream(StreamMark::gone);
  sink_->on_gone();
}

}  // namespace sonoloft::record
