#pragma once
#include <cstdint>
#include <string_view>

#include "core/io/byte_order.h"

namespace sonoloft::record::mcap {

/// Takes fields off the front of a record's content. What is not there reads as 0 or empty, and is remembered.
class Fields {
 public:
  explicit Fields(std::string_view content) : left_(content) {}

  template <class T>
  T number() {
    const std::string_view bytes = take(sizeof(T));
    return bytes.empty() ? T{} : load<T>(bytes, 0);
  }
  std::string_view text() { return take(number<std::uint32_t>()); }
  std::string_view take(std::uint64_t count) {
    short_ |= count > left_.size();
    if (short_) return {};
    const std::string_view taken = left_.substr(0, static_cast<std::size_t>(count));
    left_.remove_prefix(taken.size());
    return taken;
  }

  [[nodiscard]] std::string_view left() const { return left_; }
  /// The content ended before a field did.
  [[nodiscard]] bool is_short() const { return short_; }

 private:
  std::string_view left_;
  bool short_ = false;
};

}  // namespace sonoloft::record::mcap
