#include "tests/usb/functionfs/mock_functionfs.h"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "protocol/event.h"
#include "protocol/record.h"

namespace sonoloft::test {
namespace {

constexpr int kPatience_ms = 60'000;

std::vector<std::byte> read_all(int file, std::size_t size) {
  std::vector<std::byte> bytes(size);
  pollfd polled{file, POLLIN, 0};
  for (std::size_t got = 0; got < size;) {
    REQUIRE(poll(&polled, 1, kPatience_ms) == 1);
    const ssize_t some = ::read(file, bytes.data() + got, size - got);
    REQUIRE(some > 0);
    got += static_cast<std::size_t>(some);
  }
  return bytes;
}

}  // namespace

MockFunctionfs::MockFunctionfs() : kernel_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
  REQUIRE(kernel_ >= 0);
  REQUIRE(grantpt(kernel_) == 0);
  REQUIRE(unlockpt(kernel_) == 0);
  terminal_ = open(ptsname(kernel_), O_RDWR | O_NOCTTY | O_CLOEXEC);
  REQUIRE(terminal_ >= 0);
  termios raw{};
  REQUIRE(tcgetattr(terminal_, &raw) == 0);
  cfmakeraw(&raw);
  REQUIRE(tcsetattr(terminal_, TCSANOW, &raw) == 0);
  std::filesystem::create_symlink(ptsname(kernel_), folder_.path("ep0"));
  const auto pipe = [&](const char* name, int mode) {
    const auto path = folder_.path(name);
    REQUIRE(mkfifo(path.c_str(), 0600) == 0);
    const int end = open(path.c_str(), mode | O_NONBLOCK | O_CLOEXEC);
    REQUIRE(end >= 0);
    return end;
  };
  host_ = pipe("ep1", O_RDONLY);
  events_ = pipe("ep2", O_RDONLY);
  blobs_ = pipe("ep3", O_RDWR);  // its other end is not open yet
}

MockFunctionfs::~MockFunctionfs() {
  for (const int file : {kernel_, terminal_, host_, events_, blobs_}) close(file);
}

std::vector<std::byte> MockFunctionfs::from_control(std::size_t size) {
  return read_all(kernel_, size);
}

std::vector<std::byte> MockFunctionfs::record() {
  auto bytes = read_all(host_, sizeof(protocol::RecordHeader));
  protocol::RecordHeader header;
  std::memcpy(&header, bytes.data(), sizeof header);
  REQUIRE(header.magic == protocol::kMagic);
  const auto rest = read_all(host_, header.total_len - bytes.size());
  bytes.insert(bytes.end(), rest.begin(), rest.end());
  return bytes;
}

std::vector<std::byte> MockFunctionfs::event() {
  return read_all(events_, protocol::kEventLen);
}

void MockFunctionfs::send_block(std::span<const std::byte> block) {
  REQUIRE(::write(blobs_, block.data(), block.size()) == static_cast<ssize_t>(block.size()));
}

bool MockFunctionfs::silent() const {
  pollfd polled{host_, POLLIN, 0};
  return poll(&polled, 1, 0) == 0;
}

void MockFunctionfs::drain() {
  std::array<std::byte, 4096> bytes;
  while (::read(host_, bytes.data(), bytes.size()) > 0) {
  }
}

void MockFunctionfs::happen(usb_functionfs_event_type type) {
  usb_functionfs_event event{};
  event.type = static_cast<std::uint8_t>(type);
  send(event, {});
}

void MockFunctionfs::set_up(std::uint8_t request_type, std::uint8_t request, std::uint16_t length,
                            std::span<const std::byte> data) {
  usb_functionfs_event event{};
  event.type = FUNCTIONFS_SETUP;
  event.u.setup.bRequestType = request_type;
  event.u.setup.bRequest = request;
  event.u.setup.wLength = length;
  send(event, data);
}

void MockFunctionfs::send(const usb_functionfs_event& event, std::span<const std::byte> data) {
  std::vector<std::byte> bytes(sizeof event);
  std::memcpy(bytes.data(), &event, sizeof event);
  bytes.insert(bytes.end(), data.begin(), data.end());
  REQUIRE(::write(kernel_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
}

}  // namespace sonoloft::test
