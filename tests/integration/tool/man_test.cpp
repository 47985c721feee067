// The manual says what the program does.
#include <doctest/doctest.h>

#include <regex>
#include <set>

#include "tests/integration/tool/tool_run.h"

using namespace sonoloft::test;

namespace {

/// All matches of the expression's first group.
std::set<std::string> all(const std::string& text, const char* expression) {
  const std::regex wanted(expression);
  std::set<std::string> found;
  for (auto i = std::sregex_iterator(text.begin(), text.end(), wanted); i != std::sregex_iterator(); ++i)
    found.insert((*i)[1]);
  return found;
}

/// From one mark to the next line that begins with the other; empty where there is none.
std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const auto begin = text.find("\n" + from + "\n");
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find("\n" + to, begin + from.size()) - begin);
}

std::string manual() {
  return std::regex_replace(bytes_of("docs/sonoloft.1.in"), std::regex("\\\\-"), "-");
}

}  // namespace

TEST_CASE("manual: it has every verb of the program with its options, and explains each") {
  const TemporaryFolder folder;
  const std::string text = manual(), help = run_tool(folder, "--help").out;
  const auto verbs = all(help.substr(help.find("Subcommands:")), "\n  ([a-z-]+) ");
  CHECK(verbs.size() >= 9);
  CHECK(all(text, "\n\\.SS ([a-z-]+)") == verbs);
  std::set<std::string> used{"--help"};
  for (const std::string& verb : verbs) {
    auto options = all(run_tool(folder, verb + " --help").out, "\n +(?:-[a-z],)?(--[a-z-]+)");
    options.erase("--help");
    CAPTURE(verb);
    CHECK(all(between(text, ".SS " + verb, ".S"), "(--[a-z-]+)") == options);
    used.insert(options.begin(), options.end());
  }
  CHECK(all(between(text, ".SH OPTIONS", ".SH"), "\n\\.BI? \"?(?:-o, )?(--[a-z-]+)") == used);
}
