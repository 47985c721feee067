#pragma once
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <thread>

#include "core/slice/result.h"

// transport -> RecordingTransport -> [RECORDER] -> file

namespace sonoloft::record {

/// How far a recording is.
struct RecorderFigures {
  std::uint64_t transfers = 0;     ///< of the stream, in the file
  std::uint64_t not_recorded = 0;  ///< messages of any kind for which the disk was too slow, or could not be written
  std::uint64_t bytes = 0;         ///< in the file
  std::optional<Error> failure;    ///< of the disk: nothing is recorded any more
};

enum class StreamMark : std::uint8_t { opened, closed, gone };

/// Writes a recording (docs/recordings.md). Nobody who hands something over ever waits for the disk: it is copied, and
/// a thread writes it within a quarter of a second; another one asks the disk once a second to keep it. So a killed
/// process loses a quarter of a second, a machine without power one second and what the disk takes. What waits is at
/// most 64 MiB; what finds no room is not recorded, and is counted.
/// Threads: any, at once.
class Recorder {
 public:
  /// Makes the file. @error io_failed: there is one of that name, or it cannot be made
  [[nodiscard]] static Result<std::shared_ptr<Recorder>> create(const std::filesystem::path& path);
  /// Closes.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// A request and its reply; empty: none came.
  void exchange(std::span<const std::byte> request, std::span<const std::byte> reply);
  /// A finished transfer of the stream. @pre transfer.data() is 16-byte aligned
  void transfer(std::span<const std::byte> transfer);
  /// What the device told by itself.
  void event(std::span<const std::byte> event);
  void stream(StreamMark mark);

  [[nodiscard]] RecorderFigures figures() const;
  /// Writes what waits, and the end of the file; what comes later is not recorded.
  /// @error io_failed: the disk failed, now or before. Once, from one thread at a time.
  [[nodiscard]] Result<void> close();

 private:
  struct State;
  explicit Recorder(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace sonoloft::record
