// docs/sdk.md, docs/integration.md and examples/, from an install prefix.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <sstream>
#include <vector>

#include "tests/integration/install/installation.h"
#include "tests/support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace sonoloft::test;

namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

const std::regex kNumber("-?\\d+(\\.\\d+)?");

std::vector<double> numbers_in(const std::string& line) {
  std::vector<double> numbers;
  for (auto i = std::sregex_iterator(line.begin(), line.end(), kNumber); i != std::sregex_iterator(); ++i)
    numbers.push_back(std::stod(i->str()));
  return numbers;
}

/// The same words, and numbers to a tenth: a page need not follow every change of the mesh.
bool alike(const std::string& a, const std::string& b) {
  if (std::regex_replace(a, kNumber, "#") != std::regex_replace(b, kNumber, "#")) return false;
  const auto of_a = numbers_in(a), of_b = numbers_in(b);
  return std::equal(of_a.begin(), of_a.end(), of_b.begin(),
                    [](double x, double y) { return std::abs(x - y) <= 1 + 0.1 * std::max(std::abs(x), std::abs(y)); });
}

/// What `expected` has that `output` has not, in this order; empty when nothing is missing.
std::string missing_line(const std::string& expected, const std::string& output) {
  const auto said = lines_of(output);
  auto at = said.begin();
  for (const std::string& line : lines_of(expected)) {
    at = std::find_if(at, said.end(), [&](const std::string& s) { return alike(s, line); });
    if (at == said.end()) return line;
  }
  return {};
}

/// A scan in the guided folder. A machine that stands still for longer than the device waits for its host has not
/// scanned: then it scans again.
Ran run_scan(const std::string& command) {
  Ran ran;
  for (int attempt = 0; attempt < 5; ++attempt) {
    ran = run("cd '" + guided_folder().string() + "'\nexport LD_LIBRARY_PATH='" + (prefix() / "lib").string() + "'\n" +
              command);
    if (ran.output.find("heard nothing from the host") == std::string::npos) break;
  }
  return ran;
}

std::string symbols_of(const char* library, const char* options) {
  const Ran nm =
      run("nm " + std::string(options) + " -D --defined-only --format=posix " + (prefix() / "lib" / library).string());
  REQUIRE_MESSAGE(nm.status == 0, nm.output);
  return nm.output;
}

/// All files below a folder of the prefix.
std::vector<fs::path> files_in(const char* folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(prefix() / folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  return files;
}

}  // namespace

TEST_CASE("install: the examples say what their pages say, static and shared") {
  int examples = 0;
  for (const auto& folder : fs::directory_iterator("examples")) {
    if (!folder.is_directory()) continue;
    const std::string name = folder.path().filename().string();
    const std::string arguments = name == "reconstruct_file" ? " examples/reconstruct_file/two_balls.csl mesh.ply" : "";
    for (const char* build : {"static", "shared"}) {
      const Ran ran = run_scan(std::string("build/") + build + "/" + name + arguments);
      const std::string expected = code_in(text_of(folder.path() / "README.md"), "");
      CAPTURE(name);
      CAPTURE(build);
      CAPTURE(ran.output);
      CHECK(ran.status == 0);
      CHECK(!expected.empty());
      CHECK(missing_line(expected, ran.output) == "");
      ++examples;
    }
  }
  CHECK(examples == 16);
}

TEST_CASE("install: the program of docs/integration.md is built and says what it says there, and writes its mesh") {
  const std::string guide = text_of("docs/integration.md");
  const TemporaryFolder folder;
  static_cast<void>(folder.write("first_scan.cpp", code_in(guide, "cpp")));
  static_cast<void>(folder.write("CMakeLists.txt", code_in(guide, "cmake")));
  const Ran ran = run_scan("export HOME=\"$PWD\"\ncd '" + folder.path("").string() + "'\n" + code_in(guide, "sh"));
  CHECK_MESSAGE(ran.status == 0, ran.output);
  const std::string expected = code_in(guide, "text");
  CHECK(!expected.empty());
  CHECK_MESSAGE(missing_line(expected, ran.output) == "", ran.output);
  CHECK(fs::file_size(folder.path("first.ply")) > 100'000);
}

TEST_CASE("install: what pkg-config links runs, and C gives the same mesh however it is linked") {
  CHECK(run_scan("./c_shared shared.obj").status == 0);
  CHECK(run_scan("./c_static static.obj").status == 0);
  const std::string shared = text_of(guided_folder() / "shared.obj");
  CHECK(shared.size() > 100'000);
  CHECK(shared == text_of(guided_folder() / "static.obj"));
}

TEST_CASE("install: everything that an installed header includes is installed, and all of them compile together") {
  const std::regex include("#include \"([^\"]+)\"");
  std::string all;
  int headers = 0;
  for (const fs::path& header : files_in("include/sonoloft")) {
    ++headers;
    all += "#include \"" + header.lexically_relative(prefix() / "include/sonoloft").string() + "\"\n";
    const std::string text = text_of(header);
    for (auto i = std::sregex_iterator(text.begin(), text.end(), include); i != std::sregex_iterator(); ++i)
      CHECK_MESSAGE(fs::exists(prefix() / "include/sonoloft" / (*i)[1].str()), header, " includes ", (*i)[1].str());
  }
  CHECK(headers > 60);
  const TemporaryFolder folder;
  const Ran compiled = run("c++ -std=c++20 -fsyntax-only -isystem /usr/include/eigen3 -I'" +
                           (prefix() / "include/sonoloft").string() + "' " + folder.write("all.cpp", all).string());
  CHECK_MESSAGE(compiled.status == 0, compiled.output);
}

TEST_CASE("install: the C library exports its interface alone, all of it; the C++ library its namespace alone") {
  const std::string header = text_of(prefix() / "include/sonoloft.h"), exported = symbols_of("libsonoloft.so", "");
  const std::regex declared("(sonoloft_[a-z_]+)\\(");
  for (auto i = std::sregex_iterator(header.begin(), header.end(), declared); i != std::sregex_iterator(); ++i)
    CHECK_MESSAGE(exported.find((*i)[1].str() + " T") != std::string::npos, (*i)[1].str());
  for (const std::string& line : lines_of(exported)) CHECK_MESSAGE(line.starts_with("sonoloft_"), line);
  const auto cpp = lines_of(symbols_of("libsonoloft_cpp.so", "-C"));
  CHECK(cpp.size() > 300);
  for (const std::string& line : cpp) CHECK_MESSAGE(line.find("sonoloft::") != std::string::npos, line);
}

TEST_CASE("install: the OpenIGTLink server links, static, beside the shared library and by pkg-config") {
  if (!fs::exists(prefix() / "lib/libsonoloft_igtl.a")) {
    MESSAGE("SKIP: no OpenIGTLink: apt-get install libopenigtlink-dev, then configure anew");
    return;
  }
  const TemporaryFolder folder;
  const fs::path source = folder.write("main.cpp",
                                       "#include \"host/igtl/server.h\"\n#include <iostream>\n"
                                       "int main() {\n  sonoloft::igtl::ServerOptions options;\n  options.port = 0;\n"
                                       "  const auto server = sonoloft::igtl::Server::start(options);\n"
                                       "  (*server)->show(std::make_shared<sonoloft::MeshUpdate>());\n"
                                       "  std::cout << \"serves \" << ((*server)->port() > 0) << '\\n';\n}\n");
  static_cast<void>(
      folder.write("CMakeLists.txt",
                   "cmake_minimum_required(VERSION 3.25)\nproject(P LANGUAGES CXX)\nset(CMAKE_CXX_STANDARD 20)\n"
                   "find_package(SonoLoft REQUIRED COMPONENTS igtl)\nadd_executable(p main.cpp)\n"
                   "target_link_libraries(p PRIVATE sonoloft::igtl)\n"));
  const std::string in = "cd " + folder.path("").string() + "\nexport LD_LIBRARY_PATH='" + (prefix() / "lib").string() +
                         "' PKG_CONFIG_PATH='" + (prefix() / "lib/pkgconfig").string() + "'\n";
  for (const char* shared : {"OFF", "ON"}) {
    const Ran ran = run(in + "cmake -B " + shared + " -DBUILD_SHARED_LIBS=" + shared + " -DCMAKE_PREFIX_PATH='" +
                        prefix().string() + "'\ncmake --build " + shared + "\n" + shared + "/p");
    CHECK_MESSAGE(ran.output.find("serves 1") != std::string::npos, ran.output);
  }
  const Ran ran =
      run(in + "c++ -std=c++20 " + source.string() + " $(pkg-config --cflags --libs sonoloft-igtl) -o p\n./p");
  CHECK_MESSAGE(ran.output.find("serves 1") != std::string::npos, ran.output);
}

TEST_CASE("install: a component that is not there is an error that names those that are") {
  const TemporaryFolder folder;
  static_cast<void>(folder.write("CMakeLists.txt",
                                 "cmake_minimum_required(VERSION 3.25)\nproject(P LANGUAGES NONE)\n"
                                 "find_package(SonoLoft REQUIRED COMPONENTS capi hologram)\n"));
  const Ran ran = run("cmake -S " + folder.path("").string() + " -B " + folder.path("build").string() +
                      " -DSonoLoft_SHARED=ON -DCMAKE_PREFIX_PATH='" + prefix().string() + "'");
  CHECK(ran.status != 0);
  CHECK_MESSAGE(ran.output.find("no component hologram") != std::string::npos, ran.output);
  CHECK(ran.output.find("protocol;core;scan;probe;capi") != std::string::npos);
}
