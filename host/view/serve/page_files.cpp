#include "host/view/serve/page_files.h"

#include <array>

namespace sonoloft::view {

#ifdef SONOLOFT_WITH_PAGE
std::string_view page_html();
std::string_view page_style();
std::string_view page_script();
std::string_view page_icon();

std::span<const PageFile> page_files() {
  static const std::array files{PageFile{"/", "text/html; charset=utf-8", page_html()},
                                PageFile{"/page.css", "text/css; charset=utf-8", page_style()},
                                PageFile{"/page.js", "text/javascript; charset=utf-8", page_script()},
                                PageFile{"/icon.svg", "image/svg+xml", page_icon()}};
  return files;
}
#else
std::span<const PageFile> page_files() {
  return {};
}
#endif

}  // namespace sonoloft::view
