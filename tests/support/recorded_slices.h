#pragma once
#include <doctest/doctest.h>

#include <array>
#include <optional>
#include <string>

#include "core/io/slices/slice_files.h"
#include "tests/support/recorded_sets.h"

namespace sonoloft::test {

inline constexpr std::array kRecordedSlices = {"csl/Abdomen.csl",
                                               "csl/Heart-25-even-better.csl",
                                               "csl/Horsers.csl",
                                               "csl/ParallelEight.csl",
                                               "csl/SideBishop.csl",
                                               "csl/Vetebrae.csl",
                                               "csl/eight_15.csl",
                                               "csl/eight_20.csl",
                                               "csl/hand_ok.csl",
                                               "csl/rose.csl",
                                               "contour/mousebrain.contour",
                                               "contour/ringc.contour"};

/// The slices of a recorded set, or nothing where it is absent.
inline std::optional<SliceFile> read_recorded_slices(const std::string& name) {
  const auto path = recorded_set(name);
  if (!path) return std::nullopt;
  auto file = path->extension() == ".csl" ? read_csl(*path) : read_contour(*path);
  if (!file) FAIL(file.error().message);
  return std::move(*file);
}

}  // namespace sonoloft::test
