#include "tests/unit/house/include_rules.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>

namespace sonoloft::house {
namespace {

using Rooms = std::vector<std::string_view>;

bool lies_in(std::string_view path, const Rooms& rooms) {
  return std::any_of(rooms.begin(), rooms.end(), [&](std::string_view room) { return path.starts_with(room); });
}

/// Who may include which rooms. The first row that fits a file counts.
struct Row {
  std::string_view room;
  Rooms may_include;
};

const std::vector<Row>& table() {
  static const std::vector<Row> rows{
      {"protocol/", {"protocol/"}},
      {"device_sim/", {"device_sim/", "protocol/"}},
      {"core/slice/", {"core/slice/"}},
      {"core/", {"core/"}},
      {"host/device/", {"host/device/", "protocol/", "core/slice/"}},
      {"host/record/", {"host/record/", "host/device/", "protocol/", "core/slice/", "core/io/"}},
      {"host/scan/", {"host/scan/", "host/device/", "core/"}},
      {"host/igtl/", {"host/igtl/", "host/scan/", "host/device/", "core/"}},
      {"host/view/", {"host/view/", "host/scan/", "host/device/", "core/"}},
      {"host/simulated/", {"host/simulated/", "host/device/", "core/slice/", "device_sim/"}},
      {"host/capi/", {"host/capi/", "host/simulated/", "host/scan/", "host/device/", "core/"}},
      {"host/apps/", {"host/", "core/", "protocol/", "device_sim/"}},
      {"examples/", {"host/", "core/"}},
      {"tests/", {"tests/", "host/", "core/", "protocol/", "device_sim/"}},
  };
  return rows;
}

/// Libraries that only some rooms know.
struct Guest {
  Rooms headers;
  Rooms at_home_in;
  std::string_view why;
};

const std::vector<Guest>& guests() {
  static const std::vector<Guest> all{
      {{"CGAL/"},
       {"core/cells/", "core/methods/medial_axis/", "core/methods/network/", "core/methods/straight_skeleton/",
        "core/offline/", "tests/"},
       "CGAL is named only in core/cells, core/methods/{medial_axis,network,straight_skeleton} and core/offline"},
      {{"core/offline/"},
       {"core/offline/", "host/apps/", "tests/"},
       "core/offline is GPL: only the tool and the tests include it"},
      {{"core/methods/"},
       {"core/methods/", "host/apps/", "tests/"},
       "core/methods is for comparison: only the tool and the tests include it"},
      {{"CL/"}, {"core/gpu/", "tests/"}, "OpenCL is named only in core/gpu"},
      {{"libusb"}, {"host/device/usb/"}, "libusb is named only in host/device/usb"},
      {{"usbredir"},
       {"device_sim/port/usbredir/", "tests/"},
       "libusbredirparser is named only in device_sim/port/usbredir"},
      {{"igtlS", "igtl_"}, {"host/igtl/"}, "OpenIGTLink is named only in host/igtl"},
      {{"boost/asio", "boost/beast"},
       {"host/view/", "tests/"},
       "Boost.Asio and Boost.Beast are named only in host/view"},
  };
  return all;
}

}  // namespace

std::vector<Include> includes_of(std::string_view text) {
  std::vector<Include> found;
  std::istringstream lines{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream rest(line);
    char hash = 0, open = 0;
    std::string word, target;
    if (!(rest >> hash) || hash != '#') continue;
    for (rest >> std::ws; std::isalpha(rest.peek()) != 0;) word += static_cast<char>(rest.get());
    if (word != "include" || !(rest >> open) || (open != '<' && open != '"')) continue;
    std::getline(rest, target, open == '<' ? '>' : '"');
    found.push_back({number, target, open == '<'});
  }
  return found;
}

std::optional<std::string> complaint(std::string_view file, const Include& include) {
  static const Rooms kRooms{"protocol/", "device_sim/", "core/", "host/", "tests/"};
  static constexpr std::array<std::string_view, 5> kNotOnTheWire{"vector", "string", "memory", "thread", "iostream"};
  const auto row = std::find_if(table().begin(), table().end(), [&](const Row& r) { return file.starts_with(r.room); });
  if (row == table().end()) return "a source file that lies in no room";
  if (lies_in(include.target, kRooms) && !lies_in(include.target, row->may_include)) {
    return std::string(row->room) + " may not include " + include.target;
  }
  for (const Guest& guest : guests()) {
    if (lies_in(include.target, guest.headers) && !lies_in(file, guest.at_home_in)) return std::string(guest.why);
  }
  if (row->room == "protocol/" && include.angled &&
      std::find(kNotOnTheWire.begin(), kNotOnTheWire.end(), include.target) != kNotOnTheWire.end()) {
    return "protocol/ compiles for a microcontroller: no <" + include.target + ">";
  }
  if (include.target.starts_with("../") || include.target.starts_with("./")) return "includes start at the root";
  return std::nullopt;
}

std::optional<std::string> complaint_in_public(const Include& include) {
  const bool standard = include.target.find_first_of("/.") == std::string::npos;
  const bool of_c = include.target == "stddef.h" || include.target == "stdint.h";
  const bool welcome = of_c || include.target.starts_with("Eigen/") || include.target == "tl/expected.hpp";
  if (!include.angled || standard || welcome) return std::nullopt;
  return "a public header names no third party but Eigen: not <" + include.target + ">";
}

std::vector<std::string> public_headers(std::string_view cmake_lists) {
  std::vector<std::string> headers;
  std::string text(cmake_lists);
  std::replace(text.begin(), text.end(), ')', ' ');
  std::istringstream words(text);
  bool listing = false;
  for (std::string word; words >> word;) {
    listing = word == "HEADERS" || (listing && word.ends_with(".h"));
    if (listing && word != "HEADERS") headers.push_back(word);
  }
  return headers;
}

}  // namespace sonoloft::house
