#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sonoloft::house {

struct Include {
  int line;
  std::string target;
  bool angled;  ///< <target>, not "target"
};

/// The #include lines of a source text.
[[nodiscard]] std::vector<Include> includes_of(std::string_view text);

/// What the rules of the house have against `file` (path from the root) including that; nothing if it may.
[[nodiscard]] std::optional<std::string> complaint(std::string_view file, const Include& include);

/// What they have against a public header including that, besides complaint().
[[nodiscard]] std::optional<std::string> complaint_in_public(const Include& include);

/// The files named after HEADERS in a CMakeLists.txt.
[[nodiscard]] std::vector<std::string> public_headers(std::string_view cmake_lists);

}  // namespace sonoloft::house
