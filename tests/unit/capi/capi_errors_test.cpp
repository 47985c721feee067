// What C gets for what makes no sense.
#include <cstring>
#include <string>

#include "core/slice/result.h"
#include "tests/unit/capi/capi_scan.h"

using namespace sonoloft::test;

TEST_CASE("capi: every code of C++ has the same number and name in C") {
  for (int code = 1; code <= SONOLOFT_NOT_AVAILABLE; ++code) {
    const std::string name = sonoloft_status_name(static_cast<sonoloft_status>(code));
    CHECK(name == sonoloft::name(static_cast<sonoloft::ErrorCode>(code)));
    CHECK(name.find('_') != std::string::npos);
  }
  CHECK(std::string(sonoloft_status_name(SONOLOFT_OK)) == "ok");
  CHECK(std::string(sonoloft_status_name(SONOLOFT_DEVICE_NOT_FOUND)) == "device_not_found");
  CHECK(std::string(sonoloft_status_name(SONOLOFT_OUT_OF_MEMORY)) == "out_of_memory");
}

TEST_CASE("capi: NULL where an object is due is an error, and where nothing is to be done nothing is done") {
  sonoloft_error error{};
  CHECK(sonoloft_open_simulated(nullptr, nullptr, &error) == SONOLOFT_INVALID_ARGUMENT);
  CHECK(error.status == SONOLOFT_INVALID_ARGUMENT);
  CHECK(std::strlen(error.message) > 10);
  const auto options = scan_options();
  sonoloft_scan* scan = nullptr;
  CHECK(sonoloft_scan_open(nullptr, &options, &scan, nullptr) == SONOLOFT_INVALID_ARGUMENT);
  CHECK(sonoloft_scan_open(simulated_probe(1), nullptr, &scan, nullptr) == SONOLOFT_INVALID_ARGUMENT);
  CHECK(sonoloft_scan_open(simulated_probe(1), &options, nullptr, nullptr) == SONOLOFT_INVALID_ARGUMENT);
  CHECK(scan == nullptr);
  CHECK(sonoloft_scan_start(nullptr, nullptr, nullptr) == SONOLOFT_INVALID_ARGUMENT);
  CHECK(sonoloft_scan_withdraw(nullptr, 0, nullptr) == SONOLOFT_INVALID_ARGUMENT);
  CHECK(sonoloft_list_usb(nullptr, nullptr, nullptr) == SONOLOFT_INVALID_ARGUMENT);
  CHECK(sonoloft_watch_usb(nullptr, nullptr, nullptr, nullptr) == SONOLOFT_INVALID_ARGUMENT);
  CHECK(sonoloft_mesh_get_arrays(nullptr) == nullptr);
  CHECK(sonoloft_mesh_retain(nullptr) == nullptr);
  sonoloft_mesh_release(nullptr);
  sonoloft_scan_stop(nullptr);
  sonoloft_scan_close(nullptr);
  sonoloft_close_probe(nullptr);
  sonoloft_unwatch_usb(nullptr);
}

TEST_CASE("capi: options out of range come back as C++ says them") {
  sonoloft_error error{};
  sonoloft_scan* scan = nullptr;
  auto options = scan_options();
  options.spacing_mm = 0;
  CHECK(sonoloft_scan_open(simulated_probe(1), &options, &scan, &error) == SONOLOFT_INVALID_ARGUMENT);
  CHECK(std::string(error.message).find("spacing") != std::string::npos);
  sonoloft_simulation simulation{};
  simulation.size = sizeof simulation;
  simulation.rate_hz = 1e9;
  sonoloft_probe* probe = nullptr;
  CHECK(sonoloft_open_simulated(&simulation, &probe, &error) == SONOLOFT_INVALID_ARGUMENT);
  simulation.rate_hz = 0;
  simulation.phantom = 7;
  CHECK(sonoloft_open_simulated(&simulation, &probe, &error) == SONOLOFT_INVALID_ARGUMENT);
  CHECK(probe == nullptr);
}

TEST_CASE("capi: a probe on USB that is not there is named in the message") {
  sonoloft_probe* probe = nullptr;
  sonoloft_error error{};
  CHECK(sonoloft_open_usb("NOT-THERE-17", &probe, &error) != SONOLOFT_OK);
  CHECK(probe == nullptr);
  CHECK(std::strlen(error.message) > 10);
}

TEST_CASE("capi: a struct may be older or newer than the library") {
  sonoloft_probe* probe = nullptr;
  SUBCASE("older: the fields that it lacks have their defaults") {
    sonoloft_simulation simulation{};
    simulation.size = offsetof(sonoloft_simulation, rate_hz);
    simulation.slices = 3;
    simulation.rate_hz = -1;  // beyond the struct that the caller knows
    CHECK(sonoloft_open_simulated(&simulation, &probe, nullptr) == SONOLOFT_OK);
  }
  struct Newer {
    sonoloft_simulation known;
    double invented;
  } newer{};
  newer.known.size = sizeof newer;
  SUBCASE("newer: fields that the library does not know must be 0") {
    CHECK(sonoloft_open_simulated(&newer.known, &probe, nullptr) == SONOLOFT_OK);
  }
  SUBCASE("newer: else it says so, and does not do half of what was asked") {
    newer.invented = 1;
    sonoloft_error error{};
    CHECK(sonoloft_open_simulated(&newer.known, &probe, &error) == SONOLOFT_INVALID_ARGUMENT);
    CHECK(std::string(error.message).find("newer") != std::string::npos);
  }
  SUBCASE("without a size: it is not read") {
    newer.known.size = 0;
    CHECK(sonoloft_open_simulated(&newer.known, &probe, nullptr) == SONOLOFT_INVALID_ARGUMENT);
  }
  sonoloft_close_probe(probe);
}

TEST_CASE("capi: an output struct is written as far as the caller knows it") {
  sonoloft_scan* const scan = open_scan(2);
  struct {
    sonoloft_statistics statistics;
    std::uint64_t beyond = 0x1234;
  } caller{};
  caller.statistics.size = offsetof(sonoloft_statistics, made);
  caller.statistics.made = 77;
  CHECK(sonoloft_scan_statistics(scan, &caller.statistics, nullptr) == SONOLOFT_OK);
  CHECK(caller.statistics.size == offsetof(sonoloft_statistics, made));
  CHECK(caller.statistics.made == 77);
  caller.statistics.size = sizeof caller;
  CHECK(sonoloft_scan_statistics(scan, &caller.statistics, nullptr) == SONOLOFT_OK);
  CHECK(caller.statistics.made == 0);
  CHECK(caller.beyond == 0x1234);
  sonoloft_scan_close(scan);
}
