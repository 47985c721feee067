#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/slice/result.h"
#include "host/device/transport.h"

// file -> [REPLAY TRANSPORT] -> session

namespace sonoloft::record {

/// What is in a recording.
struct RecordingFacts {
  std::size_t runs = 0;         ///< of the probe, from a START to its end
  std::uint64_t transfers = 0;  ///< of all runs
  double seconds = 0;           ///< from the first message to the last
  /// The file ends too early, as that of a killed process does: one line that says where. All before is replayed.
  std::optional<std::string> cut;
};

/// A probe that does again what it did when it was recorded: each run of a session gets the transfers of the next
/// recorded run, bit by bit but for the session's id; then the data end, or the probe goes away as it did then and
/// reopen() finds it again. What a probe says of itself is as it was, but that it can wait: a lossless stream is held
/// back. It has no clock of its own: times of the device stay what they were and are not mapped to the host's.
class ReplayTransport final : public device::Transport {
 public:
  /// Reads the file through, once, and checks all of it.
  /// @param speed  1: as fast as it was recorded, 2: twice as fast; 0: as fast as it is taken. Finite, not below 0
  /// @error those of RecordingReader; empty_input (there is no run in it). @cost the file is read; memory: one chunk
  [[nodiscard]] static Result<std::unique_ptr<ReplayTransport>> open(const std::filesystem::path& path, double speed);
  ~ReplayTransport() override;

  [[nodiscard]] const RecordingFacts& facts() const;
  /// There are runs that were not begun yet. From any thread.
  [[nodiscard]] bool more() const;

  [[nodiscard]] Result<std::size_t> control(std::span<const std::byte> request, std::span<std::byte> reply,
                                            std::chrono::milliseconds timeout) override;
  [[nodiscard]] Result<void> start_stream(device::TransferSink& sink, std::size_t max_record) override;
  void stop_stream() override;
  [[nodiscard]] Result<void> reopen() override;

 private:
  struct State;
  explicit ReplayTransport(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace sonoloft::record
