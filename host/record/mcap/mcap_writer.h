#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/slice/result.h"
#include "host/record/mcap/mcap_chunk.h"

// chunks -> [MCAP WRITER] -> file

namespace sonoloft::record::mcap {

struct Schema {
  std::uint16_t id;  ///< not 0
  std::string name, encoding, data;
};
struct Channel {
  std::uint16_t id;
  std::uint16_t schema;  ///< its id
  std::string topic, encoding;
};

/// What a file says before its first message.
struct Opening {
  std::string profile, library;
  std::vector<Schema> schemas;
  std::vector<Channel> channels;
};

/// Writes an MCAP file from its beginning to its end. What write() and write_metadata() returned from survives the
/// death of this process; what sync() returned from, that of the machine. Such a file has no summary, which readers can
/// do without. Threads: one at a time, but for sync(), which may run beside the others.
class McapWriter {
 public:
  /// Makes the file. @error io_failed: there is one of that name, or it cannot be made
  [[nodiscard]] static Result<std::unique_ptr<McapWriter>> create(const std::filesystem::path& path,
                                                                  const Opening& opening);
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// @error io_failed: the file is to be written no further; what it has up to there can be read
  [[nodiscard]] Result<void> write(const McapChunk& chunk);
  [[nodiscard]] Result<void> write_metadata(const std::string& name, const std::map<std::string, std::string>& values);
  /// The summary and the end. @pre called once, last
  [[nodiscard]] Result<void> finish();
  /// Waits until the disk has it. @error io_failed
  [[nodiscard]] Result<void> sync();

  [[nodiscard]] std::uint64_t size() const { return offset_; }  ///< bytes so far

 private:
  McapWriter(std::filesystem::path path, int file, const Opening& opening);
  [[nodiscard]] Result<void> put(const std::string& bytes);
  [[nodiscard]] std::string statistics() const;
  [[nodiscard]] tl::unexpected<Error> failure(int error) const;

  const std::filesystem::path path_;
  const int file_;
  std::uint64_t offset_ = 0;
  std::uint32_t crc_ = 0;  ///< of all bytes so far

  // For the summary: records as they will stand there.
  std::string opening_, chunk_indexes_, metadata_indexes_;
  std::uint16_t schemas_;
  std::uint32_t channels_, chunks_ = 0, metadata_ = 0;
  std::map<std::uint16_t, std::uint64_t> messages_;  ///< [channel]
  std::uint64_t start_ns_ = 0, end_ns_ = 0;
};

}  // namespace sonoloft::record::mcap
