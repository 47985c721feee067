#include "host/record/recording_transport.h"

namespace sonoloft::record {

Result<std::size_t> RecordingTransport::control(std::span<const std::byte> request, std::span<std::byte> reply,
                                                std::chrono::milliseconds timeout) {
  auto size = transport_->control(request, reply, timeout);
  recorder_->exchange(request, size ? std::span<const std::byte>(reply).first(*size) : std::span<const std::byte>());
  return size;
}

Result<void> RecordingTransport::start_stream(device::TransferSink& sink, std::size_t max_record) {
  sink_ = &sink;
  recorder_->stream(StreamMark::opened);
  return transport_->start_stream(*this, max_record);
}

void RecordingTransport::stop_stream() {
  transport_->stop_stream();
  if (sink_ != nullptr) recorder_->stream(StreamMark::closed);
  sink_ = nullptr;
}

void RecordingTransport::on_transfer(std::span<const std::byte> transfer) {
  recorder_->transfer(transfer);
  sink_->on_transfer(transfer);
}

void RecordingTransport::on_event(std::span<const std::byte> event) {
  recorder_->event(event);
  sink_->on_event(event);
}

void RecordingTransport::on_gone() {
  recorder_->stream(StreamMark::gone);
  sink_->on_gone();
}

}  // namespace sonoloft::record
