#pragma once
#include <doctest/doctest.h>

#include <filesystem>
#include <optional>

namespace sonoloft::test {

/// A file of the recorded sets that lie beside the source tree and are not part of it. Nothing, and a word about it,
/// where they are absent. Tests run in the source tree.
inline std::optional<std::filesystem::path> recorded_set(const std::filesystem::path& name) {
  const std::filesystem::path path = std::filesystem::path("../shared/data") / name;
  if (std::filesystem::exists(path)) return path;
  MESSAGE("SKIP: ", path.string(), " is absent");
  return std::nullopt;
}

}  // namespace sonoloft::test
