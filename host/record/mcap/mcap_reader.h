#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/slice/result.h"
#include "host/record/mcap/mcap_format.h"

// file -> [MCAP READER] -> message by message

namespace sonoloft::record::mcap {

/// A message, as a view that is good until the next call of the reader.
struct Message {
  std::string_view topic;
  std::uint64_t time_ns = 0;        ///< since the Unix epoch
  std::span<const std::byte> data;  ///< not aligned
};

/// Reads an MCAP file of uncompressed chunks from its beginning to its end; no index, no summary is needed, but every
/// sum that is there is checked. In memory is one chunk, of up to kMaxRecordLen bytes. Errors say at which byte of the
/// file. Threads: one at a time.
class McapReader {
 public:
  /// @error file_not_found, io_failed, unsupported_format (no MCAP file), empty_input (cut off in its header)
  [[nodiscard]] static Result<std::unique_ptr<McapReader>> open(const std::filesystem::path& path);
  ~McapReader();
  McapReader(const McapReader&) = delete;
  McapReader& operator=(const McapReader&) = delete;

  [[nodiscard]] const std::string& profile() const { return profile_; }
  [[nodiscard]] const std::string& library() const { return library_; }

  /// The next message, in the order of the file; nothing at its end.
  /// @error parse_failed (the file is damaged), unsupported_format (a compressed chunk), too_large, io_failed
  [[nodiscard]] Result<std::optional<Message>> next();

  /// Where the record that is read now begins, from the beginning of the file.
  [[nodiscard]] std::uint64_t position() const { return position_; }
  /// After the end: the file ends within a record, as that of a killed process does. One line that says where.
  [[nodiscard]] const std::optional<std::string>& cut() const { return cut_; }
  /// @return an error that says where: "file: byte N: what"
  [[nodiscard]] tl::unexpected<Error> failure(ErrorCode code, const std::string& what) const;

 private:
  McapReader(std::filesystem::path path, int file, std::uint64_t size);

  [[nodiscard]] Result<void> read_opening();
  [[nodiscard]] Result<bool> read_record();
  [[nodiscard]] Result<bool> read(std::size_t length, std::string& bytes);
  [[nodiscard]] Result<void> take();
  [[nodiscard]] Result<void> take_chunk();
  [[nodiscard]] Result<void> take_channel(std::string_view content);
  [[nodiscard]] Result<void> take_data_end();
  [[nodiscard]] Result<void> take_footer();
  [[nodiscard]] Result<std::optional<Message>> next_of_chunk();
  [[nodiscard]] tl::unexpected<Error> damaged(const std::string& what) const;

  const std::filesystem::path path_;
  const int file_;
  const std::uint64_t size_;

  std::uint64_t offset_ = 0;      ///< of the bytes to read next
  std::uint64_t position_ = 0;    ///< of the record at hand
  std::uint32_t crc_ = 0;         ///< of all bytes before offset_, after the data's end: of those of the summary
  std::uint32_t crc_before_ = 0;  ///< the same, before the record at hand
  bool data_ended_ = false, ended_ = false;
  std::optional<std::string> cut_;

  std::string head_, content_;  ///< of the record at hand
  std::string profile_, library_;
  std::map<std::uint16_t, std::string> topics_;  ///< [channel]
  std::size_t next_ = 0;                         ///< in content_, of the chunk's next record; 0: no chunk is at hand
};

}  // namespace sonoloft::record::mcap
