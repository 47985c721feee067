#pragma once
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/temporary_folder.h"

namespace sonoloft::test {

struct ToolRun {
  int status;
  std::string out, err;
};

inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Runs the tool in `folder`, so that relative paths of `arguments` are there.
/// @param before  shell words in front of the tool, e.g. an assignment
inline ToolRun run_tool(const TemporaryFolder& folder, const std::string& arguments, const std::string& before = "") {
  const std::string command = "cd '" + folder.path("").string() + "' && " + before + " '" SONOLOFT_TOOL "' " +
                              arguments + " >stdout.txt 2>stderr.txt";
  const int status = std::system(command.c_str());
  REQUIRE(WIFEXITED(status));
  return {WEXITSTATUS(status), bytes_of(folder.path("stdout.txt")), bytes_of(folder.path("stderr.txt"))};
}

inline nlohmann::json json_of(const std::filesystem::path& path) {
  return nlohmann::json::parse(bytes_of(path));
}

/// Slices of a box of 20 x 20 x 20 (label 1) around the origin with a box of 10 x 10 x 10 (label 2) in it: 9 planes
/// along z, then 5 along x.
inline std::string boxes_csl() {
  const auto square = [](int axis, double at, double half) {
    std::string text;
    const double a[4] = {-half, half, half, -half}, b[4] = {-half, -half, half, half};
    for (int i = 0; i < 4; ++i) {
      const std::string u = std::to_string(a[i]), v = std::to_string(b[i]), w = std::to_string(at);
      text += axis == 2 ? u + " " + v + " " + w + "\n" : w + " " + u + " " + v + "\n";
    }
    return text;
  };
  std::string text = "CSLC\n14 2\n";
  int id = 1;
  const auto plane = [&](int axis, double at) {
    const bool inner = at > -5 && at < 5;
    text += std::to_string(id++) + (inner ? " 8 2 " : " 4 1 ") + (axis == 2 ? "0 0 1 " : "1 0 0 ") +
            std::to_string(-at) + "\n" + square(axis, at, 10) + (inner ? square(axis, at, 5) : "") + "4 1 0 1 2 3\n" +
            (inner ? "4 2 4 5 6 7\n" : "");
  };
  for (int i = 0; i < 9; ++i) plane(2, -9.6 + 2.4 * i);
  for (int i = 0; i < 5; ++i) plane(0, -8.5 + 4.25 * i);
  return text;
}

/// The surface of a box from the origin to `corner`, as an OFF file.
inline std::string box_off(double x, double y, double z) {
  std::string text = "OFF\n8 12 0\n";
  for (int i = 0; i < 8; ++i)
    text += std::to_string(i & 1 ? x : 0.0) + " " + std::to_string(i & 2 ? y : 0.0) + " " +
            std::to_string(i & 4 ? z : 0.0) + "\n";
  return text +
         "3 0 2 1\n3 1 2 3\n3 4 5 6\n3 5 7 6\n3 0 1 4\n3 1 5 4\n3 2 6 3\n3 3 6 7\n3 0 4 2\n3 2 4 6\n3 1 3 5\n3 3 7 5\n";
}

}  // namespace sonoloft::test
