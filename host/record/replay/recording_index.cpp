#include "host/record/replay/recording_index.h"

#include <algorithm>

namespace sonoloft::record {

using protocol::Command;

void RecordingIndex::take(const RecordedExchange& exchange) {
  const auto request = protocol::parse_request(exchange.request);
  const auto reply = protocol::parse_reply(exchange.reply);
  if (!request || !reply || reply->status != protocol::Status::ok) return;
  const auto keep = [&](std::vector<std::byte>& first) {
    if (first.empty()) first.assign(reply->payload.begin(), reply->payload.end());
  };
  if (request->command == Command::get_info) keep(info);
  if (request->command == Command::get_calibration) keep(calibration);
  protocol::StartRequest start;
  if (request->command == Command::start && !streams.empty() && protocol::read_payload(request->payload, start))
    streams.back() = start.session_id;
}

Result<RecordingIndex> RecordingIndex::of(const std::filesystem::path& path) {
  auto reader = RecordingReader::open(path);
  if (!reader) return tl::unexpected<Error>(reader.error());
  RecordingIndex index;
  std::uint64_t first_ns = 0, last_ns = 0;
  while (true) {
    const auto next = reader->next();
    if (!next) return tl::unexpected<Error>(next.error());
    if (!*next) break;
    last_ns = (*next)->time_ns;
    if (first_ns == 0) first_ns = last_ns;
    if (const auto* exchange = std::get_if<RecordedExchange>(&(*next)->what)) index.take(*exchange);
    if (std::holds_alternative<RecordedTransfer>((*next)->what)) ++index.facts.transfers;
    const auto* mark = std::get_if<StreamMark>(&(*next)->what);
    if (mark != nullptr && *mark == StreamMark::opened) index.streams.emplace_back();
  }
  const auto started = [](const std::optional<std::uint32_t>& id) { return id.has_value(); };
  const auto runs = std::count_if(index.streams.begin(), index.streams.end(), started);
  index.facts.runs = static_cast<std::size_t>(runs);
  index.facts.seconds = static_cast<double>(last_ns - std::min(first_ns, last_ns)) * 1e-9;
  index.facts.cut = reader->cut();
  if (runs == 0 || index.info.empty() || index.calibration.empty())
    return fail(ErrorCode::empty_input,
                index.facts.cut.value_or(path.string() + ": no probe was started in this recording") +
                    ": there is nothing to replay");
  return index;
}

}  // namespace sonoloft::record
