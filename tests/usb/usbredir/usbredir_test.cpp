// The redirection server against a virtual machine's end without the machine.
#include <doctest/doctest.h>

#include <array>
#include <cstring>
#include <random>

#include "device_sim/port/usbredir/usbredir_server.h"
#include "device_sim/simulator/memory_blobs.h"
#include "protocol/block.h"
#include "protocol/command.h"
#include "protocol/crc32c.h"
#include "protocol/event.h"
#include "protocol/usb.h"
#include "tests/support/wire/hanging_port.h"
#include "tests/support/wire/loopback_bench.h"
#include "tests/usb/usbredir/redirected_device.h"

using namespace sonoloft;
using namespace sonoloft::test;
using device_sim::usbredir::UsbredirServer;
using Kind = RedirectedDevice::Packet::Kind;

namespace {

const device_sim::usb::UsbIdentity kIdentity{"LOOP-1", device_sim::record_slot_len(kTestLimits)};
constexpr std::uint8_t kStreamIn = device_sim::usb::kStreamIn;

std::unique_ptr<UsbredirServer> serve(protocol::Port& port) {
  auto server = UsbredirServer::start(port, kIdentity, 0);
  REQUIRE_MESSAGE(server.value, server.error);
  return std::move(server.value);
}

void check_connected(RedirectedDevice& device) {
  const auto packet = device.next();
  REQUIRE(packet);
  CHECK(packet->kind == Kind::connect);
}

/// START of a lossless stream.
void start_stream(RedirectedDevice& device) {
  std::array<std::byte, protocol::kMaxRequestLen> request{};
  const protocol::StartRequest start{7, protocol::kSliceStream, 1, 1, 0};
  const auto len = protocol::encode_request(protocol::Command::start, 1, protocol::bytes_of(start), request);
  device.submit_control(1, 0x41, 1, 0, static_cast<std::uint16_t>(len), std::span(request).first(len));
  const auto reply = device.next();
  REQUIRE(reply);
  REQUIRE(reply->status == usb_redir_success);
}

std::uint64_t seq_of(const RedirectedDevice::Packet& packet) {
  protocol::RecordHeader header;
  REQUIRE(packet.data.size() >= sizeof header);
  std::memcpy(&header, packet.data.data(), sizeof header);
  CHECK(header.magic == protocol::kMagic);
  CHECK(header.total_len == packet.data.size());
  return header.seq;
}

}  // namespace

TEST_CASE("usbredir: a machine that connects is told what the descriptors say") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1));
  const auto server = serve(loopback.port());
  RedirectedDevice device(server->tcp_port());
  check_connected(device);
  CHECK(+device.connected.speed == usb_redir_speed_high);
  CHECK(+device.connected.vendor_id == protocol::usb::kVendorId);
  CHECK(+device.connected.product_id == protocol::usb::kProductId);
  CHECK(+device.connected.device_version_bcd == protocol::usb::kDeviceVersion);
  CHECK(+device.interface.interface_count == 1);
  CHECK(device.interface.interface_class[0] == protocol::usb::kInterfaceClass);
  CHECK(+device.endpoints.type[16 + 1] == usb_redir_type_bulk);
  CHECK(+device.endpoints.max_packet_size[16 + 1] == 512);
  CHECK(+device.endpoints.type[1] == usb_redir_type_bulk);  // for blobs
  CHECK(+device.endpoints.type[2] == usb_redir_type_invalid);

  device.set_configuration(5, 1);
  const auto configured = device.next();
  REQUIRE(configured);
  CHECK(configured->kind == Kind::configuration);
  CHECK(configured->status == usb_redir_success);
  CHECK(configured->number == 1);
  device.get_alt_setting(6);
  const auto setting = device.next();
  REQUIRE(setting);
  CHECK(setting->kind == Kind::alt_setting);
  CHECK(setting->status == usb_redir_success);
  CHECK(setting->number == 0);
}

TEST_CASE("usbredir: 1,000 records come whole and in order") {
  constexpr std::uint64_t kRecords = 1000, kUnderWay = 4, kFirst = 1ull << 40;
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(kRecords));
  const auto server = serve(loopback.port());
  RedirectedDevice device(server->tcp_port());
  check_connected(device);
  start_stream(device);
  for (std::uint64_t i = 0; i < kUnderWay; ++i) device.submit_bulk(kFirst + i, kStreamIn, 1u << 17);
  for (std::uint64_t i = 0; i < kRecords; ++i) {
    const auto packet = device.next();
    REQUIRE(packet);
    REQUIRE(packet->kind == Kind::bulk);
    REQUIRE(packet->id == kFirst + i);
    REQUIRE(packet->status == usb_redir_success);
    REQUIRE(packet->length == packet->data.size());
    REQUIRE(seq_of(*packet) == i);
    device.submit_bulk(kFirst + kUnderWay + i, kStreamIn, 1u << 17);
  }
}

TEST_CASE("usbredir: a record that does not fit into its transfer is babble") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(2));
  const auto server = serve(loopback.port());
  RedirectedDevice device(server->tcp_port());
  check_connected(device);
  start_stream(device);
  device.submit_bulk(2, kStreamIn, 700);
  CHECK(device.next()->status == usb_redir_babble);
  device.submit_bulk(3, kStreamIn, 1u << 16);
  CHECK(seq_of(*device.next()) == 1);  // at a record again
}

TEST_CASE("usbredir: what waits is answered once, whether it is cancelled, reset, or ended before") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1));
  const auto server = serve(loopback.port());
  RedirectedDevice device(server->tcp_port());
  check_connected(device);
  device.submit_bulk(1, kStreamIn, 4096);
  device.cancel(1);
  device.submit_bulk(2, kStreamIn, 4096);
  device.submit_bulk(3, kStreamIn, 4096);
  device.reset();
  device.submit_control(4, 0x80, 6, 0x0100, 18);
  for (const std::uint64_t id : {1u, 2u, 3u}) {
    const auto packet = device.next();
    REQUIRE(packet);
    CHECK(packet->id == id);
    CHECK(packet->status == usb_redir_cancelled);
    CHECK(packet->length == 0);
  }
  const auto descriptor = device.next();
  REQUIRE(descriptor);
  CHECK(descriptor->id == 4);
  CHECK(descriptor->data.size() == 18);
  device.cancel(4);
  device.submit_control(5, 0x80, 6, 0x0303, 255);
  CHECK(device.next()->id == 5);  // nothing came for the late cancellation
}

TEST_CASE("usbredir: requests that make no sense stall, and the next one is answered") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1));
  const auto server = serve(loopback.port());
  RedirectedDevice device(server->tcp_port());
  check_connected(device);
  device.submit_control(1, 0x80, 6, 0x0309, 255);  // no such string
  CHECK(device.next()->status == usb_redir_stall);
  device.submit_control(2, 0xC1, 2, 0, 4088);  // a reply, though nothing was asked
  CHECK(device.next()->status == usb_redir_stall);
  device.submit_bulk(3, 0x85, 64);  // no such endpoint
  CHECK(device.next()->status == usb_redir_stall);
  device.set_configuration(4, 7);
  CHECK(device.next()->status == usb_redir_stall);
  device.submit_control(5, 0x80, 6, 0x0303, 255);
  CHECK(device.next()->data.size() == 2 + 2 * 6);  // "LOOP-1"
}

TEST_CASE("usbredir: what was asked twice at once ends the connection") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1));
  const auto server = serve(loopback.port());
  RedirectedDevice device(server->tcp_port());
  check_connected(device);
  device.submit_bulk(1, kStreamIn, 4096);
  device.submit_bulk(1, kStreamIn, 4096);
  CHECK_FALSE(device.next());
}

TEST_CASE("usbredir: whatever bytes come, the connection ends or is answered and the next machine is served") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1));
  const auto server = serve(loopback.port());
  for (std::uint32_t seed = 0; seed < 2000; ++seed) {
    std::mt19937 random(seed);
    RedirectedDevice device(server->tcp_port(), seed % 4 != 1);
    if (seed % 4 == 0) check_connected(device);
    // Packets of a sensible frame: type, length, id, then bytes that need not fit.
    for (std::uint32_t packet = random() % 8; packet > 0; --packet) {
      const auto type = static_cast<std::uint32_t>(random() % 2 == 0 ? random() % 30 : 100 + random() % 6);
      const auto length = static_cast<std::uint32_t>(random() % 8 == 0 ? random() : random() % 24);
      std::vector<std::byte> bytes(16 + (length < 24 ? length : random() % 24));
      for (std::byte& b : bytes) b = static_cast<std::byte>(random() % 4 == 0 ? random() & 0xFF : random() % 3);
      std::memcpy(bytes.data(), &type, sizeof type);
      std::memcpy(bytes.data() + 4, &length, sizeof length);
      device.send_raw(bytes);
    }
  }
  RedirectedDevice last(server->tcp_port());
  check_connected(last);
}

TEST_CASE("usbredir: a device that hangs holds up nothing but its own transfers, a machine the next until it leaves") {
  HangingPort port;
  const auto server = serve(port);
  std::optional<RedirectedDevice> first(server->tcp_port());
  check_connected(*first);
  RedirectedDevice second(server->tcp_port());
  const std::array<std::byte, 8> request{};
  first->submit_bulk(1, kStreamIn, 4096);
  first->submit_control(2, 0x41, 1, 0, 8, request);
  for (const std::uint64_t id : {1u, 2u}) {
    first->cancel(id);
    CHECK(first->next()->status == usb_redir_cancelled);
  }
  CHECK(second.silent());
  first.reset();
  check_connected(second);
  port.release();
}

TEST_CASE("usbredir: when the device goes, its transfers fail, the machine is told, and the connection ends") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1));
  const auto server = serve(loopback.port());
  RedirectedDevice device(server->tcp_port());
  check_connected(device);
  device.submit_bulk(1, kStreamIn, 4096);
  loopback.unplug();
  CHECK(device.next()->status == usb_redir_ioerror);
  const auto disconnected = device.next();
  REQUIRE(disconnected);
  CHECK(disconnected->kind == Kind::disconnect);
  CHECK_FALSE(device.next());
}

TEST_CASE("usbredir: a TCP port that is taken is named") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1));
  const auto server = serve(loopback.port());
  HangingPort other;
  const auto second = UsbredirServer::start(other, kIdentity, server->tcp_port());
  CHECK_FALSE(second.value);
  CHECK(second.error.find(std::to_string(server->tcp_port())) != std::string::npos);
}

TEST_CASE("usbredir: events come while the machine receives them, each once, and not before or after") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(0));
  const auto server = serve(loopback.port());
  RedirectedDevice device(server->tcp_port());
  check_connected(device);
  CHECK(+device.endpoints.type[0x12] == usb_redir_type_interrupt);
  CHECK(+device.endpoints.max_packet_size[0x12] == 64);
  start_stream(device);
  device.start_receiving(5, device_sim::usb::kEventIn);
  CHECK(device.next()->kind == Kind::receiving);
  for (std::uint16_t i = 0; i < 20; ++i) {
    loopback.button(i, true);
    std::optional<protocol::EventMessage> event;
    do {  // the end of the data is among them
      const auto packet = device.next();
      REQUIRE(packet);
      REQUIRE(packet->kind == Kind::interrupt);
      event = protocol::parse_event(packet->data);
      REQUIRE(event);
    } while (event->kind != static_cast<std::uint16_t>(protocol::EventKind::button));
    CHECK(event->number == i);
  }
  device.stop_receiving(6, device_sim::usb::kEventIn);
  const auto stopped = device.next();
  CHECK(stopped->kind == Kind::receiving);
  CHECK(stopped->status == usb_redir_success);
  loopback.button(99, true);
  device.start_receiving(7, 0x83);
  CHECK(device.next()->status == usb_redir_inval);
  CHECK(device.silent());
  device.start_receiving(8, device_sim::usb::kEventIn);
  CHECK(device.next()->kind == Kind::receiving);
  const auto late = device.next();
  REQUIRE(late->kind == Kind::interrupt);
  CHECK(protocol::parse_event(late->data)->number == 99);
}

TEST_CASE("usbredir: a blob's blocks reach the firmware") {
  device_sim::MemoryBlobs store;
  auto options = loopback_options();
  options.firmware.blobs = &store;
  device_sim::LoopbackDevice loopback(options, numbered_slices(0));
  const auto server = serve(loopback.port());
  RedirectedDevice device(server->tcp_port());
  check_connected(device);
  const std::vector<std::byte> blob(3000, std::byte{0x5A});
  const protocol::BeginBlobRequest begin{1, 3000, protocol::crc32c(blob), 0};
  std::array<std::byte, protocol::kMaxRequestLen> bytes{};
  auto len = protocol::encode_request(protocol::Command::begin_blob, 1, protocol::bytes_of(begin), bytes);
  device.submit_control(1, 0x41, 1, 0, static_cast<std::uint16_t>(len), std::span(bytes).first(len));
  REQUIRE(device.next()->status == usb_redir_success);
  len = protocol::encode_block({0, blob}, bytes);
  device.submit_bulk_out(2, device_sim::usb::kBlobOut, std::span(bytes).first(len));
  const auto taken = device.next();
  CHECK(taken->status == usb_redir_success);
  CHECK(taken->length == len);
  len = protocol::encode_request(protocol::Command::get_blob, 3, {}, bytes);
  device.submit_control(3, 0x41, 1, 0, static_cast<std::uint16_t>(len), std::span(bytes).first(len));
  REQUIRE(device.next()->status == usb_redir_success);
  device.submit_control(4, 0xC1, 2, 0, 64);
  const auto reply = device.next();
  protocol::BlobReply state;
  REQUIRE(
      protocol::read_payload(std::span<const std::byte>(reply->data).subspan(sizeof(protocol::ReplyHeader)), state));
  CHECK(state.received == 3000);
  CHECK(state.state == static_cast<std::uint16_t>(protocol::BlobState::complete));
}
