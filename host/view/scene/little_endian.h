#pragma once
#include <bit>
#include <cstddef>
#include <span>
#include <string>

namespace sonoloft::view {

static_assert(std::endian::native == std::endian::little, "the page reads the bytes as they lie in memory");

template <class T>
void append(std::string& out, std::span<const T> values) {
  out.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}

template <class T>
void append(std::string& out, const T& value) {
  append(out, std::span<const T>(&value, 1));
}

}  // namespace sonoloft::view
