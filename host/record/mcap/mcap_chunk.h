#pragma once
#include <cstdint>
#include <initializer_list>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

// message by message -> [CHUNK] -> McapWriter -> file

namespace sonoloft::record::mcap {

/// Messages that go into the file together, uncompressed, with the sum over them and the index of each channel.
/// Threads: one at a time.
class McapChunk {
 public:
  /// A message whose data are `parts`, one after the other. Times: ns since the Unix epoch, as all of the file.
  /// @pre a channel of that id is written before the chunk is
  void add(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns,
           std::initializer_list<std::span<const std::byte>> parts);

  [[nodiscard]] bool empty() const { return index_.empty(); }
  [[nodiscard]] std::size_t size() const { return records_.size(); }  ///< bytes
  [[nodiscard]] std::uint64_t start_ns() const { return start_ns_; }
  [[nodiscard]] std::uint64_t end_ns() const { return end_ns_; }

  using Entry = std::pair<std::uint64_t, std::uint64_t>;  ///< time, ns; offset into the chunk's records
  [[nodiscard]] const std::map<std::uint16_t, std::vector<Entry>>& index() const { return index_; }
  /// The record of the chunk, whole.
  [[nodiscard]] std::string encoded() const;

 private:
  std::string records_;
  std::map<std::uint16_t, std::vector<Entry>> index_;  ///< [channel]
  std::uint64_t start_ns_ = 0, end_ns_ = 0;
};

}  // namespace sonoloft::record::mcap
