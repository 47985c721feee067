#pragma once
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string_view>

namespace sonoloft::fuzz {

/// The fuzzer's bytes, taken piece by piece; when they are used up all is zero.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : left_(std::as_bytes(std::span(data, size))) {}

  [[nodiscard]] bool empty() const { return left_.empty(); }
  [[nodiscard]] std::span<const std::byte> take(std::size_t count) {
    const auto piece = left_.first(count < left_.size() ? count : left_.size());
    left_ = left_.subspan(piece.size());
    return piece;
  }
  template <class T>
  T number() {
    T value{};
    const auto piece = take(sizeof value);
    std::memcpy(&value, piece.data(), piece.size());
    return value;
  }
  [[nodiscard]] std::span<const std::byte> rest() { return take(left_.size()); }

 private:
  std::span<const std::byte> left_;
};

/// What must hold for every input.
inline void demand(bool holds) {
  if (!holds) std::abort();
}

inline std::string_view text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace sonoloft::fuzz
