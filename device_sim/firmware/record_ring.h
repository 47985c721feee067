#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace sonoloft::device_sim {

/// Records that wait for the bus, in slots of one length in memory that somebody else owns. First in, first out.
/// Threads: one at a time.
class RecordRing {
 public:
  /// @pre memory.data() is 64-byte aligned, memory.size() >= slot_len, slot_len is a positive multiple of 64
  RecordRing(std::span<std::byte> memory, std::size_t slot_len);

  [[nodiscard]] bool empty() const { return used_ == 0; }
  [[nodiscard]] bool full() const { return used_ == capacity_; }
  [[nodiscard]] std::uint16_t used() const { return used_; }
  [[nodiscard]] std::uint16_t capacity() const { return capacity_; }
  [[nodiscard]] std::size_t slot_len() const { return slot_len_; }

  /// The free slot that push() will keep. @pre !full()
  [[nodiscard]] std::span<std::byte> free_slot();
  /// Keeps what free_slot() holds as the newest record. @pre !full()
  void push();

  /// The oldest record. @pre !empty()
  [[nodiscard]] std::span<std::byte> oldest();
  /// Forgets the oldest record. @pre !empty()
  void pop();
  void clear();

 private:
  [[nodiscard]] std::span<std::byte> slot(std::size_t index) { return memory_.subspan(index * slot_len_, slot_len_); }

  std::span<std::byte> memory_;
  std::size_t slot_len_;
  std::uint16_t capacity_;
  std::uint16_t first_ = 0, used_ = 0;
};

}  // namespace sonoloft::device_sim
