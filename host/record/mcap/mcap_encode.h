#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "core/io/byte_order.h"
#include "host/record/mcap/mcap_format.h"

// Pieces of records, as MCAP's specification serialises them.

namespace sonoloft::record::mcap {

inline void append_text(std::string& out, std::string_view text) {
  append(out, static_cast<std::uint32_t>(text.size()));
  out += text;
}

inline void append_record(std::string& out, Opcode opcode, std::string_view content) {
  append(out, opcode);
  append(out, static_cast<std::uint64_t>(content.size()));
  out += content;
}

/// A map: the length in bytes, then what `entries` has.
inline void append_map(std::string& out, const std::map<std::string, std::string>& map) {
  std::string entries;
  for (const auto& [key, value] : map) {
    append_text(entries, key);
    append_text(entries, value);
  }
  append_text(out, entries);
}

inline void append_map(std::string& out, const std::map<std::uint16_t, std::uint64_t>& map) {
  std::string entries;
  for (const auto& [key, value] : map) {
    append(entries, key);
    append(entries, value);
  }
  append_text(out, entries);
}

}  // namespace sonoloft::record::mcap
