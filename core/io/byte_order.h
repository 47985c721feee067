#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <string>
#include <string_view>

namespace sonoloft {

static_assert(std::endian::native == std::endian::little, "append() and load() are written for little-endian hosts");

/// Appends a number, little-endian.
template <class T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// The number that begins at an offset. @pre offset + sizeof(T) <= bytes.size()
template <class T>
T load(std::string_view bytes, std::size_t offset, std::endian order = std::endian::little) {
  assert(offset + sizeof(T) <= bytes.size());
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes.data() + offset, sizeof(T));
  if (order == std::endian::big) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

}  // namespace sonoloft
