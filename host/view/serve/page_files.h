#pragma once
#include <span>
#include <string_view>

namespace sonoloft::view {

/// A file of the page, as the build put it into this program.
struct PageFile {
  std::string_view path;  ///< "/", "/page.js", ...
  std::string_view type;  ///< for the header Content-Type
  std::string_view bytes;
};

/// Empty where the program was built without npm.
[[nodiscard]] std::span<const PageFile> page_files();

}  // namespace sonoloft::view
