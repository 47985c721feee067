#include "tests/integration/install/installation.h"

#include <doctest/doctest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "tests/support/temporary_folder.h"

namespace sonoloft::test {
namespace fs = std::filesystem;

Ran run(const std::string& lines) {
  const TemporaryFolder folder;
  const fs::path script = folder.write("lines.sh", "set -e\n" + lines);
  FILE* const pipe = popen(("sh " + script.string() + " 2>&1").c_str(), "r");
  REQUIRE(pipe);
  std::string output;
  std::array<char, 4096> part;
  while (const std::size_t count = std::fread(part.data(), 1, part.size(), pipe)) output.append(part.data(), count);
  const int ended = pclose(pipe);
  return {WIFEXITED(ended) ? WEXITSTATUS(ended) : -1, output};
}

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  REQUIRE_MESSAGE(file, path.string());
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string code_in(const std::string& document, const std::string& language) {
  const std::string open = "\n```" + language + "\n", close = "\n```\n";
  std::string code;
  for (auto at = document.find(open); at != std::string::npos; at = document.find(open, at)) {
    at += open.size();
    const auto end = document.find(close, at);
    code += document.substr(at, end - at) + "\n";
    at = end + close.size();
  }
  return code;
}

const fs::path& guided_folder() {
  static const fs::path path = fs::path(SONOLOFT_BUILD_FOLDER) / "install_test";  // the same each time, for the cache
  static const bool done = [] {
    fs::remove_all(path);
    fs::create_directories(path / "build");
    fs::create_directory_symlink(SONOLOFT_BUILD_FOLDER, path / "build/release");
    fs::create_directory_symlink(fs::current_path() / "examples", path / "examples");
    const std::string cached =
        "if command -v ccache; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_DIR=$(ccache -k cache_dir); fi\n";
    const Ran ran =
        run(cached + "export HOME='" + path.string() + "'\ncd \"$HOME\"\n" + code_in(text_of("docs/sdk.md"), "sh"));
    REQUIRE_MESSAGE(ran.status == 0, ran.output);
    return true;
  }();
  REQUIRE(done);
  return path;
}

}  // namespace sonoloft::test
