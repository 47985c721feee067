#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/slice/result.h"
#include "host/record/mcap/mcap_reader.h"
#include "host/record/recorder.h"

// file -> McapReader -> [RECORDING READER] -> what was recorded, piece by piece -> replay

namespace sonoloft::record {

struct RecordedTransfer {
  std::span<std::byte> bytes;  ///< 64-byte aligned
};
struct RecordedEvent {
  std::span<std::byte> bytes;
};
struct RecordedExchange {
  std::span<const std::byte> request, reply;  ///< reply empty: none came
};

/// One thing that was recorded; its views are good until the reader's next call.
struct Recorded {
  std::uint64_t time_ns;  ///< since the Unix epoch
  std::variant<RecordedTransfer, RecordedEvent, RecordedExchange, StreamMark> what;
};

/// Reads a recording from its beginning to its end. Threads: one at a time.
class RecordingReader {
 public:
  /// @error those of McapReader::open(); unsupported_format: an MCAP file of something else
  [[nodiscard]] static Result<RecordingReader> open(const std::filesystem::path& path);

  /// In the order in which it was recorded; nothing at the end. @error those of McapReader::next()
  [[nodiscard]] Result<std::optional<Recorded>> next();

  /// See McapReader.
  [[nodiscard]] const std::optional<std::string>& cut() const { return file_->cut(); }
  [[nodiscard]] tl::unexpected<Error> failure(ErrorCode code, const std::string& what) const {
    return file_->failure(code, what);
  }

 private:
  explicit RecordingReader(std::unique_ptr<mcap::McapReader> file) : file_(std::move(file)) {}
  Result<std::optional<Recorded>> decoded(const mcap::Message& message);

  struct alignas(64) Block {
    std::byte bytes[64];
  };
  std::unique_ptr<mcap::McapReader> file_;
  std::vector<Block> message_, inner_;  ///< what `Recorded` refers to
};

}  // namespace sonoloft::record
