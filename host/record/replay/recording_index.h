#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/slice/result.h"
#include "host/record/replay/recording_reader.h"
#include "host/record/replay/replay_transport.h"
#include "protocol/command.h"

// file -> [RECORDING INDEX] -> what a replay has to know before it begins

namespace sonoloft::record {

/// A recording, read through once.
struct RecordingIndex {
  /// @error those of RecordingReader; empty_input: it has no run
  [[nodiscard]] static Result<RecordingIndex> of(const std::filesystem::path& path);

  RecordingFacts facts;
  std::vector<std::byte> info, calibration;  ///< payloads of the first replies
  /// [stream that was opened] the session's id; nothing where none was started.
  std::vector<std::optional<std::uint32_t>> streams;

 private:
  void take(const RecordedExchange& exchange);
};

}  // namespace sonoloft::record
