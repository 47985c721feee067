#pragma once
// What labels are called and how they look:  colour table -> [LABEL TABLE] -> meshes, volumes, pictures, reports
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "core/slice/label.h"
#include "core/slice/result.h"

namespace sonoloft {

using Rgb = std::array<std::uint8_t, 3>;  ///< red, green, blue

/// The colour of a label that no table names: far apart for neighbouring numbers; the same for ever.
[[nodiscard]] Rgb label_colour(Label label);

/// Name and colour of every label: those that the table states, else `label N` and label_colour(). Threads: reading
/// from any.
class LabelTable {
 public:
  /// Never empty, without line breaks.
  [[nodiscard]] std::string name(Label label) const;
  [[nodiscard]] Rgb colour(Label label) const;

  /// States a label, once. @pre the name is as name() promises @return false: the table states it already
  [[nodiscard]] bool add(Label label, std::string name, const Rgb& colour);

 private:
  struct Entry {
    std::string name;
    Rgb colour;
  };
  std::map<Label, Entry> entries_;
};

/// Reads a colour table of 3D Slicer (.ctbl): a line each `label name red green blue opacity`, 0..255; `_` in a name
/// stands for a blank, a line that begins with # is a comment. Opacity may be absent, and is not used.
/// Source: Slicer's developer guide, "Color table file format".
/// @error file_not_found, io_failed, parse_failed (with the line; also a label stated twice), bad_contour (a label
/// above
///        kMaxLabel), too_large
[[nodiscard]] Result<LabelTable> read_label_table(const std::filesystem::path& path);

/// The same from text in memory; `name` is what messages call it.
[[nodiscard]] Result<LabelTable> parse_label_table(std::string_view text, std::string_view name);

}  // namespace sonoloft
