#include <doctest/doctest.h>

#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "core/slice/result.h"

using namespace sonoloft;

TEST_CASE("errors: every code has a name of its own and a row in docs/errors.md, and the page has no others") {
  std::ifstream file("docs/errors.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  std::set<std::string> names;
  for (std::uint16_t code = 1; std::string(name(static_cast<ErrorCode>(code))) != "unknown_error"; ++code) {
    const std::string own = name(static_cast<ErrorCode>(code));
    CHECK_MESSAGE(names.insert(own).second, own);
    CHECK_MESSAGE(page.find("\n| `" + own + "` |") != std::string::npos, own);
  }
  std::size_t rows = 0;
  for (std::size_t at = page.find("\n| `"); at != std::string::npos; at = page.find("\n| `", at + 1)) ++rows;
  CHECK(rows == names.size());
  CHECK(names.contains(name(ErrorCode::not_available)));  // the last one: no gap ended the count
}
