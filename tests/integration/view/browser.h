#pragma once
// page -> [BROWSER] -> what it saw
#include <doctest/doctest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <nlohmann/json.hpp>
#include <string>

namespace sonoloft::test {

inline const std::filesystem::path kPageFolder = SONOLOFT_VIEW_FOLDER;

inline bool browser_is_there() {
  const bool there = std::filesystem::exists("/usr/bin/chromium") &&
                     std::filesystem::exists(SONOLOFT_PAGE_MODULES "/playwright-core") &&
                     std::system("node --version > /dev/null 2>&1") == 0;
  if (!there)
    MESSAGE("SKIP: no /usr/bin/chromium, node or " SONOLOFT_PAGE_MODULES
            "/playwright-core: apt install chromium, ./run build");
  return there;
}

/// Starts the browser; the future has its exit status.
inline std::future<int> drive(const std::string& url, const std::string& scenario, int seconds = 0) {
  std::filesystem::create_directories(kPageFolder);
  std::filesystem::remove(kPageFolder / (scenario + ".json"));
  const std::string command = "timeout " + std::to_string(300 + 2 * seconds) +
                              " node tests/integration/view/drive_page.mjs '" SONOLOFT_PAGE_MODULES "' '" + url + "' " +
                              scenario + " '" + kPageFolder.string() + "' " + std::to_string(seconds);
  return std::async(std::launch::async, [command] { return std::system(command.c_str()); });
}

inline nlohmann::json report_of(const std::string& scenario) {
  std::ifstream file(kPageFolder / (scenario + ".json"));
  return nlohmann::json::parse(file, nullptr, false);
}

inline bool done(const std::future<int>& browser) {
  return browser.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

}  // namespace sonoloft::test
