// The function of a Linux gadget, without a gadget.
#include <doctest/doctest.h>

#include <array>
#include <cstring>
#include <map>

#include "device_sim/port/functionfs/function_words.h"
#include "device_sim/port/functionfs/functionfs_device.h"
#include "device_sim/simulator/memory_blobs.h"
#include "protocol/block.h"
#include "protocol/command.h"
#include "protocol/crc32c.h"
#include "protocol/event.h"
#include "protocol/usb.h"
#include "tests/support/wire/loopback_bench.h"
#include "tests/usb/functionfs/mock_functionfs.h"

using namespace sonoloft;
using namespace sonoloft::test;
using device_sim::functionfs::FunctionfsDevice;

namespace {

constexpr std::size_t kFunction = 9 + 3 * 7, kDescriptors = 12 + 8 + 2 * kFunction, kStrings = 16;
constexpr std::uint8_t kVendorOut = 0x41, kVendorIn = 0xC1;
const device_sim::usb::UsbIdentity kIdentity{"LOOP-1", device_sim::record_slot_len(kTestLimits)};

std::unique_ptr<FunctionfsDevice> start(protocol::Port& port, MockFunctionfs& mounted) {
  auto function = FunctionfsDevice::start(port, kIdentity, mounted.folder());
  REQUIRE_MESSAGE(function.value, function.error);
  return std::move(function.value);
}

std::uint32_t number(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// @return the reply's bytes
template <class Payload>
std::vector<std::byte> exchange(MockFunctionfs& mounted, protocol::Command command, std::uint32_t id,
                                const Payload& payload, std::size_t reply_len) {
  std::array<std::byte, protocol::kMaxRequestLen> request{};
  const auto len = protocol::encode_request(command, id, payload, request);
  mounted.set_up(kVendorOut, protocol::usb::kSendRequest, static_cast<std::uint16_t>(len),
                 std::span(request).first(len));
  mounted.set_up(kVendorIn, protocol::usb::kReadReply, protocol::kMaxRequestLen);
  auto reply = mounted.from_control(reply_len);
  protocol::ReplyHeader header;
  std::memcpy(&header, reply.data(), sizeof header);
  CHECK(header.status == static_cast<std::uint16_t>(protocol::Status::ok));
  CHECK(header.request_id == id);
  return reply;
}

void start_stream(MockFunctionfs& mounted, std::uint32_t session) {
  const protocol::StartRequest start{session, protocol::kSliceStream, 1, 1, 0};
  (void)exchange(mounted, protocol::Command::start, session, protocol::bytes_of(start), sizeof(protocol::ReplyHeader));
}

}  // namespace

TEST_CASE("functionfs: the function says the interface and the endpoints of the device model, the gadget the rest") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1));
  MockFunctionfs mounted;
  const auto function = start(loopback.port(), mounted);
  const auto said = mounted.from_control(kDescriptors);
  CHECK(number(said, 0) == FUNCTIONFS_DESCRIPTORS_MAGIC_V2);
  CHECK(number(said, 4) == kDescriptors);
  CHECK(number(said, 8) == (FUNCTIONFS_HAS_FS_DESC | FUNCTIONFS_HAS_HS_DESC));
  for (const std::size_t speed : {0u, 1u}) {
    CHECK(number(said, 12 + 4 * speed) == 4);
    const auto interface = std::span(said).subspan(20 + speed * kFunction, kFunction);
    CHECK(interface[0] == std::byte{9});
    CHECK(interface[5] == std::byte{protocol::usb::kInterfaceClass});
    CHECK(interface[9] == std::byte{7});
    CHECK(interface[11] == std::byte{device_sim::usb::kStreamIn});
    CHECK((number(interface, 12) >> 8 & 0xFFFF) == (speed == 0 ? 64 : 512));
    CHECK(interface[18] == std::byte{device_sim::usb::kEventIn});
    CHECK(interface[25] == std::byte{device_sim::usb::kBlobOut});
  }
  const auto strings = mounted.from_control(kStrings);
  CHECK(number(strings, 0) == FUNCTIONFS_STRINGS_MAGIC);
  CHECK(number(strings, 4) == kStrings);

  std::map<std::string, std::string> gadget;
  for (const auto& [name, value] : device_sim::functionfs::gadget_attributes(function->descriptors())) {
    gadget[name] = value;
  }
  CHECK(std::stoul(gadget["idVendor"], nullptr, 16) == protocol::usb::kVendorId);
  CHECK(std::stoul(gadget["idProduct"], nullptr, 16) == protocol::usb::kProductId);
  CHECK(std::stoul(gadget["bcdDevice"], nullptr, 16) == protocol::usb::kDeviceVersion);
  CHECK(gadget["strings/0x409/manufacturer"] == "SonoLoft");
  CHECK(gadget["strings/0x409/serialnumber"] == "LOOP-1");
}

TEST_CASE("functionfs: requests are answered, and what makes no sense costs the next one nothing") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1));
  MockFunctionfs mounted;
  const auto function = start(loopback.port(), mounted);
  (void)mounted.from_control(kDescriptors + kStrings);
  mounted.happen(FUNCTIONFS_BIND);
  mounted.set_up(kVendorIn, protocol::usb::kReadReply, 64);  // nothing was asked
  mounted.set_up(kVendorIn, 77, 64);
  mounted.set_up(kVendorOut, protocol::usb::kSendRequest, 0);
  mounted.set_up(kVendorOut, protocol::usb::kSendRequest, 0xFFFF);
  mounted.set_up(0xA1, 1, 8);
  mounted.happen(FUNCTIONFS_SUSPEND);
  mounted.happen(FUNCTIONFS_RESUME);
  const auto reply = exchange(mounted, protocol::Command::get_info, 5, std::span<const std::byte>{},
                              sizeof(protocol::ReplyHeader) + sizeof(protocol::InfoReply));
  protocol::InfoReply info;
  std::memcpy(&info, reply.data() + sizeof(protocol::ReplyHeader), sizeof info);
  CHECK(std::string(info.serial) == "LOOP-1");
}

TEST_CASE("functionfs: records come whole and in order while the host has configured the device, and not otherwise") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1u << 30));
  MockFunctionfs mounted;
  const auto function = start(loopback.port(), mounted);
  (void)mounted.from_control(kDescriptors + kStrings);
  for (const std::uint32_t session : {1u, 2u}) {
    start_stream(mounted, session);
    CHECK(mounted.silent());
    mounted.happen(FUNCTIONFS_ENABLE);
    for (std::uint32_t i = 0; i < 10; ++i) {  // they fit into a pipe
      protocol::RecordHeader header;
      std::memcpy(&header, mounted.record().data(), sizeof header);
      CHECK(header.session_id == session);
      CHECK(header.seq == i);
    }
    mounted.happen(FUNCTIONFS_DISABLE);
    (void)exchange(mounted, protocol::Command::stop, 9, std::span<const std::byte>{}, sizeof(protocol::ReplyHeader));
    mounted.drain();
  }
}

TEST_CASE("functionfs: events go out and blocks come in while the host has configured the device") {
  device_sim::MemoryBlobs store;
  auto options = loopback_options();
  options.firmware.blobs = &store;
  device_sim::LoopbackDevice loopback(options, numbered_slices(1u << 30));
  MockFunctionfs mounted;
  const auto function = start(loopback.port(), mounted);
  (void)mounted.from_control(kDescriptors + kStrings);
  mounted.happen(FUNCTIONFS_ENABLE);

  const std::vector<std::byte> blob(2500, std::byte{0x5A});
  const protocol::BeginBlobRequest begin{2, 2500, protocol::crc32c(blob), 0};
  (void)exchange(mounted, protocol::Command::begin_blob, 1, protocol::bytes_of(begin), sizeof(protocol::ReplyHeader));
  std::array<std::byte, protocol::kMaxRequestLen> block{};
  std::uint32_t received = 0;
  for (const std::uint32_t from : {0u, 1500u}) {
    const auto data = std::span(blob).subspan(from, from == 0 ? 1500 : 1000);
    mounted.send_block(std::span(block).first(protocol::encode_block({from, data}, block)));
    while (received != from + data.size()) {  // blocks of a pipe have no ends: one after the other
      const auto reply = exchange(mounted, protocol::Command::get_blob, 2, std::span<const std::byte>{},
                                  sizeof(protocol::ReplyHeader) + sizeof(protocol::BlobReply));
      received = number(reply, sizeof(protocol::ReplyHeader) + offsetof(protocol::BlobReply, received));
    }
  }

  start_stream(mounted, 3);
  for (const std::uint16_t button : {std::uint16_t{4}, std::uint16_t{5}}) {
    loopback.button(button, true);
    const auto event = protocol::parse_event(mounted.event());
    REQUIRE(event);
    CHECK(event->session_id == 3);
    CHECK(event->number == button);
  }
}

TEST_CASE("functionfs: a folder that is none is named, with what to do") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1));
  const TemporaryFolder empty;
  const auto function = FunctionfsDevice::start(loopback.port(), kIdentity, empty.path("").string());
  CHECK_FALSE(function.value);
  CHECK(function.error.find("ep0 cannot be opened") != std::string::npos);
  CHECK(function.error.find("mount a functionfs") != std::string::npos);
}
