#include <doctest/doctest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>

#include "sonoloft/version.h"
#include "tests/unit/house/include_rules.h"

namespace fs = std::filesystem;
using namespace sonoloft::house;

namespace {

std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

bool has_ending(const fs::path& path, std::initializer_list<const char*> endings) {
  return std::any_of(endings.begin(), endings.end(), [&](const char* e) { return path.extension() == e; });
}

bool is_source(const fs::path& path) {
  return has_ending(path, {".h", ".cpp", ".c", ".cl"});
}

/// Text that people write: sources, build files, documents, scripts. The tests run in the root of the source tree.
bool is_text(const fs::path& path) {
  return is_source(path) || has_ending(path, {".md", ".cmake", ".txt", ".json", ".fbs", ".in", ".py", ".sh"}) ||
         path.filename() == "run";
}

void each_file(const std::function<bool(const fs::path&)>& wanted,
               const std::function<void(const std::string& path, const std::string& text)>& visit) {
  for (auto entry = fs::recursive_directory_iterator("."); entry != fs::recursive_directory_iterator(); ++entry) {
    const fs::path path = entry->path().lexically_normal();
    if (entry->is_directory() && (path == "build" || path == "out" || path == ".git"))
      entry.disable_recursion_pending();
    if (entry->is_regular_file() && wanted(path)) visit(path.generic_string(), content(path));
  }
}

Include angled(const char* target) {
  return {1, target, true};
}
Include quoted(const char* target) {
  return {1, target, false};
}

}  // namespace

TEST_CASE("house: the rule checker reads include lines however they are written") {
  const auto found =
      includes_of("#pragma once\n#include <vector>\n  # include \"core/slice/label.h\"  // why\n// #include <x>\n");
  REQUIRE(found.size() == 2);
  CHECK(found[0].target == "vector");
  CHECK(found[0].angled);
  CHECK(found[1].target == "core/slice/label.h");
  CHECK(found[1].line == 3);
  CHECK(!found[1].angled);
}

TEST_CASE("house: the rule checker objects to every kind of line that it is there for") {
  CHECK(complaint("protocol/record.h", angled("vector")));
  CHECK(complaint("protocol/record.h", quoted("core/slice/label.h")));
  CHECK(complaint("device_sim/probe/phantom.h", quoted("core/slice/label.h")));
  CHECK(complaint("device_sim/firmware/firmware.h", quoted("host/device/session.h")));
  CHECK(complaint("core/slice/section.cpp", quoted("core/cells/cell_complex.h")));
  CHECK(complaint("core/field/field.cpp", quoted("host/scan/scan_session.h")));
  CHECK(complaint("core/io/slices/csl.cpp", quoted("protocol/record.h")));
  CHECK(complaint("core/mesh/mesh.h", quoted("tests/support/mesh/mesh_check.h")));
  CHECK(complaint("core/mesh/mesh.cpp", angled("CGAL/Epick.h")));
  CHECK(complaint("core/methods/stack/slice_stack.cpp", angled("CGAL/Epick.h")));
  CHECK(complaint("core/reconstructor/reconstructor.cpp", quoted("core/offline/delaunay_mesher.h")));
  CHECK(complaint("core/reconstructor/reconstructor.cpp", quoted("core/methods/catalogue.h")));
  CHECK(complaint("core/field/field.cpp", angled("CL/opencl.hpp")));
  CHECK(complaint("host/device/session.cpp", quoted("core/cells/cell_complex.h")));
  CHECK(complaint("host/device/session.cpp", quoted("device_sim/port/cable.h")));
  CHECK(complaint("host/device/session.cpp", angled("libusb-1.0/libusb.h")));
  CHECK(complaint("host/scan/scan_session.cpp", quoted("protocol/record.h")));
  CHECK(complaint("host/capi/capi_scan.cpp", quoted("device_sim/simulator/simulated_device.h")));
  CHECK(complaint("examples/live_mesh/live_mesh.cpp", quoted("device_sim/simulator/simulated_device.h")));
  CHECK(complaint("core/mesh/mesh.cpp", quoted("../slice/label.h")));
  CHECK(complaint("attic/old.cpp", angled("vector")));
  CHECK(complaint_in_public(angled("CGAL/Epick.h")));
  CHECK(complaint_in_public(angled("zlib.h")));
}

TEST_CASE("house: the rule checker lets through what the table allows") {
  CHECK(!complaint("protocol/record.h", angled("cstdint")));
  CHECK(!complaint("device_sim/port/cable.h", quoted("protocol/port.h")));
  CHECK(!complaint("core/cells/exact_plane.cpp", angled("CGAL/Exact_rational.h")));
  CHECK(!complaint("core/offline/labelled_complex.h", angled("CGAL/Mesh_triangulation_3.h")));
  CHECK(!complaint("core/octree/octree.h", quoted("core/field/field.h")));
  CHECK(!complaint("host/device/usb/usb_transport.cpp", angled("libusb-1.0/libusb.h")));
  CHECK(!complaint("host/scan/scan_session.h", quoted("core/reconstructor/reconstructor.h")));
  CHECK(!complaint("host/simulated/simulated_probe.cpp", quoted("device_sim/simulator/simulated_device.h")));
  CHECK(!complaint("host/apps/tool/demo.cpp", quoted("device_sim/probe/simulated_probe.h")));
  CHECK(!complaint("tests/unit/io/csl_test.cpp", quoted("core/io/slices/slice_files.h")));
  CHECK(!complaint("core/mesh/mesh.h", quoted("sonoloft/version.h")));
  CHECK(!complaint_in_public(angled("vector")));
  CHECK(!complaint_in_public(angled("stdint.h")));
  CHECK(!complaint_in_public(angled("Eigen/Core")));
  CHECK(!complaint_in_public(quoted("core/slice/label.h")));
  CHECK(public_headers("sonoloft_module(x\n SOURCES a.cpp\n HEADERS a.h b/c.h\n PUBLIC y)") ==
        std::vector<std::string>{"a.h", "b/c.h"});
}

TEST_CASE("house: no source file includes what it may not") {
  int files = 0, includes = 0;
  each_file(is_source, [&](const std::string& path, const std::string& text) {
    ++files;
    for (const Include& include : includes_of(text)) {
      ++includes;
      const auto objection = complaint(path, include);
      CHECK_MESSAGE(!objection, path, ":", include.line, ": ", objection.value_or(""));
    }
  });
  MESSAGE("source files: ", files, ", include lines: ", includes);
  CHECK(includes > 100);
}

TEST_CASE("house: public headers exist and name no third party but Eigen") {
  int headers = 0;
  each_file([](const fs::path& p) { return p.filename() == "CMakeLists.txt"; },
            [&](const std::string& lists, const std::string& text) {
              for (const std::string& name : public_headers(text)) {
                ++headers;
                const fs::path header = fs::path(lists).parent_path() / name;
                CHECK_MESSAGE(fs::exists(header), header.generic_string());
                for (const Include& include : includes_of(content(header))) {
                  const auto objection = complaint_in_public(include);
                  CHECK_MESSAGE(!objection, header.generic_string(), ":", include.line, ": ", objection.value_or(""));
                }
              }
            });
  MESSAGE("public headers: ", headers);
  CHECK(headers > 5);
}

TEST_CASE("house: what ships of CGAL is LGPL by the header's own word") {
  int includes = 0;
  each_file(is_source, [&](const std::string& path, const std::string& text) {
    if (path.starts_with("tests/") || path.starts_with("core/offline/")) return;
    for (const Include& include : includes_of(text)) {
      if (!include.target.starts_with("CGAL/")) continue;
      ++includes;
      const std::string header = content("/usr/include/" + include.target);
      CHECK_MESSAGE(header.find("SPDX-License-Identifier: LGPL-3.0-or-later") != std::string::npos, path, ":",
                    include.line, ": <", include.target, "> is not there or not LGPL");
    }
  });
  MESSAGE("includes of CGAL outside of the tests: ", includes);
}

TEST_CASE("house: nothing but tests and benchmarks knows data beside the source tree") {
  const std::string beside = "../shared";
  each_file(is_text, [&](const std::string& path, const std::string& text) {
    if (!path.starts_with("tests/")) CHECK_MESSAGE(text.find(beside) == std::string::npos, path);
  });
}

TEST_CASE("house: the version is stated once") {
  const std::string version = SONOLOFT_VERSION;
  CHECK(std::count(version.begin(), version.end(), '.') == 2);
  const auto is_part = [](char c) { return c == '.' || std::isdigit(static_cast<unsigned char>(c)) != 0; };
  each_file(is_text, [&](const std::string& path, const std::string& text) {
    int count = 0;
    for (auto at = text.find(version); at != std::string::npos; at = text.find(version, at + 1)) {
      const std::size_t end = at + version.size();
      count += (at == 0 || !is_part(text[at - 1])) && (end == text.size() || !is_part(text[end]));
    }
    if (path == "CMakeLists.txt") {
      CHECK(count == 1);
    } else if (path != "CHANGELOG.md" && !path.starts_with("tests/")) {  // golden bytes state versions of their own
      CHECK_MESSAGE(count == 0, path, " repeats the version ", version);
    }
  });
}

TEST_CASE("house: every test that docs/requirements.md names exists") {
  std::string tests;
  each_file([](const fs::path& path) { return path.extension() == ".cpp"; },
            [&](const std::string& path, const std::string& text) {
              if (path.starts_with("tests/")) tests += text;
            });
  const std::string page = content("docs/requirements.md");
  int named = 0;
  for (std::size_t open = page.find('"'); open != std::string::npos; ++named) {
    const std::size_t close = page.find('"', open + 1);
    REQUIRE(close != std::string::npos);
    const std::string title = page.substr(open, close - open + 1);
    CHECK_MESSAGE(tests.find("TEST_CASE(" + title) != std::string::npos, title);
    open = page.find('"', close + 1);
  }
  MESSAGE("tests named: " << named);
  CHECK(named > 40);
}
