// The USB/IP server against a host's end without a kernel.
#include <doctest/doctest.h>

#include <array>
#include <atomic>
#include <cstring>
#include <future>
#include <random>
#include <thread>

#include "device_sim/port/usbip/usbip_server.h"
#include "protocol/usb.h"
#include "tests/support/wire/hanging_port.h"
#include "tests/support/wire/loopback_bench.h"
#include "tests/usb/usbip/usbip_client.h"
#include "tests/usb/usbip/usbip_transport.h"

using namespace sonoloft;
using namespace sonoloft::test;
using device::EventKind;
using device_sim::usbip::UsbipServer;

namespace {

constexpr device::StreamOptions kLossless{device::StreamMode::lossless, 16};
constexpr std::int32_t kStalled = -EPIPE, kCancelled = -ECONNRESET;

const device_sim::usb::UsbIdentity kIdentity{"LOOP-1", device_sim::record_slot_len(kTestLimits)};

std::unique_ptr<UsbipServer> serve(protocol::Port& port) {
  auto server = UsbipServer::start(port, kIdentity, 0);
  REQUIRE_MESSAGE(server.value, server.error);
  return std::move(server.value);
}

std::unique_ptr<device::Session> open_over(const UsbipServer& server, UsbipTransport** transport = nullptr) {
  auto made = std::make_unique<UsbipTransport>(server.tcp_port());
  if (transport != nullptr) *transport = made.get();
  auto session = device::Session::open(std::move(made));
  if (!session) FAIL(session.error().message);
  return std::move(*session);
}

/// A port that answers no request, and whose stream is halted until that is cleared.
class TroubledPort final : public protocol::Port {
 public:
  ~TroubledPort() = default;
  protocol::PortTransfer control(std::span<const std::byte>, std::span<std::byte>) override {
    return {protocol::PortStatus::timed_out, 0};
  }
  protocol::PortTransfer read(std::span<std::byte>, std::uint32_t) override {
    if (halted_) return {protocol::PortStatus::halted, 0};
    return wait();
  }
  protocol::PortTransfer read_event(std::span<std::byte>, std::uint32_t) override { return wait(); }
  protocol::PortTransfer write_block(std::span<const std::byte>) override { return wait(); }
  void cancel_reads() override {}
  void allow_reads() override {}
  void clear_halt() override { halted_ = false; }

 private:
  static protocol::PortTransfer wait() {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return {protocol::PortStatus::timed_out, 0};
  }
  std::atomic<bool> halted_ = true;
};

}  // namespace

TEST_CASE("usbip: the device is listed with what its descriptors say") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1));
  const auto server = serve(loopback.port());
  UsbipClient client(server->tcp_port());
  const auto list = client.list();
  REQUIRE(list.size() == 328);
  CHECK(list[11] == std::byte{1});  // device
  const auto u16 = [&](std::size_t at) {
    return std::to_integer<unsigned>(list[at]) << 8 | std::to_integer<unsigned>(list[at + 1]);
  };
  CHECK(std::strcmp(reinterpret_cast<const char*>(list.data()) + 12 + 256, "1-1") == 0);
  CHECK(u16(312) == protocol::usb::kVendorId);
  CHECK(u16(314) == protocol::usb::kProductId);
  CHECK(u16(316) == protocol::usb::kDeviceVersion);
  CHECK(list[324] == std::byte{protocol::usb::kInterfaceClass});
}

TEST_CASE("usbip: one host at a time, and another as soon as it has gone") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1));
  const auto server = serve(loopback.port());
  for (int round = 0; round < 10; ++round) {
    UsbipClient first(server->tcp_port()), second(server->tcp_port()), third(server->tcp_port());
    REQUIRE(third.import("9-9") == 4);
    std::uint32_t status = first.import();
    while (status == 2) status = UsbipClient(server->tcp_port()).import();  // until the last round's is dropped
    if (round == 0) REQUIRE(second.import() == 2);
  }
}

TEST_CASE("usbip: a session over it delivers 1,000 slices in order, and the books close") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1000));
  const auto server = serve(loopback.port());
  Inbox inbox;
  auto session = open_over(*server);
  REQUIRE(session->start(kLossless, inbox.callbacks()));
  REQUIRE(inbox.wait_for(EventKind::end_of_data));
  session->stop();
  const auto slices = inbox.slices();
  REQUIRE(slices.size() == 1000);
  for (std::size_t i = 0; i < slices.size(); ++i) REQUIRE(slices[i]->slice.id == i);
  check_closed(session->ledger());
  CHECK(session->ledger().transport_lost == 0);
}

TEST_CASE("usbip: pulled out in the middle of a stream 100 times, every host says so once and the next one streams") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1u << 30));
  const auto server = serve(loopback.port());
  for (std::size_t round = 0; round < 100; ++round) {
    Inbox inbox;
    UsbipTransport* transport = nullptr;
    auto session = open_over(*server, &transport);
    REQUIRE(session->start({}, inbox.callbacks()));
    REQUIRE(inbox.wait_for_slices(1 + round % 5));
    transport->unplug();
    REQUIRE(inbox.wait_for(EventKind::disconnected));
    session->stop();
    CHECK(inbox.count(EventKind::disconnected) == 1);
    check_closed(session->ledger());
  }
}

TEST_CASE("usbip: a transfer that waits is cancelled, one that has ended was answered before") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1));
  const auto server = serve(loopback.port());
  UsbipClient client(server->tcp_port());
  REQUIRE(client.import() == 0);
  const auto waiting = client.submit(1, 4096);
  const auto unlink = client.unlink(waiting);
  const auto cancelled = client.next_reply();
  REQUIRE(cancelled);
  CHECK(cancelled->command == 4);
  CHECK(cancelled->seqnum == unlink);
  CHECK(cancelled->status == kCancelled);

  const auto descriptor = client.submit_control(0x80, 6, 0x0100, 18);
  const auto done = client.next_reply();
  REQUIRE(done);
  CHECK(done->seqnum == descriptor);
  CHECK(done->data.size() == 18);
  (void)client.unlink(descriptor);
  const auto late = client.next_reply();
  REQUIRE(late);
  CHECK(late->command == 4);
  CHECK(late->status == 0);
}

TEST_CASE("usbip: requests that make no sense stall, and the next one is answered") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1));
  const auto server = serve(loopback.port());
  UsbipClient client(server->tcp_port());
  REQUIRE(client.import() == 0);
  struct Bad {
    std::uint8_t request_type, request;
    std::uint16_t value, length;
  };
  constexpr std::array<Bad, 8> kBad{{{0x80, 6, 0x0309, 255},  // no such string
                                     {0x80, 99, 0, 2},
                                     {0x00, 9, 7, 0},     // no such configuration
                                     {0xC1, 2, 0, 4088},  // a reply, though nothing was asked
                                     {0x41, 1, 0, 0},     // a request without bytes
                                     {0xC1, 77, 0, 8},
                                     {0xA1, 1, 0, 8},  // a class request
                                     {0x02, 1, 5, 0}}};
  for (const Bad& bad : kBad) {
    CAPTURE(int{bad.request});
    CAPTURE(bad.value);
    (void)client.submit_control(bad.request_type, bad.request, bad.value, bad.length);
    const auto reply = client.next_reply();
    REQUIRE(reply);
    CHECK(reply->status == kStalled);
  }
  // What sends to the device gets nothing back.
  (void)client.submit_control(0x00, 0, 0, 2, std::array<std::byte, 2>{});
  CHECK(client.next_reply()->status == kStalled);
  (void)client.submit(5, 64);
  CHECK(client.next_reply()->status == kStalled);
  (void)client.submit_control(0x80, 6, 0x0303, 255);
  CHECK(client.next_reply()->data.size() == 2 + 2 * 6);  // "LOOP-1"
}

TEST_CASE("usbip: a record longer than the transfer goes on in the next one, or is cut where a packet does not fit") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(3));
  const auto server = serve(loopback.port());
  UsbipClient client(server->tcp_port());
  REQUIRE(client.import() == 0);
  std::array<std::byte, protocol::kMaxRequestLen> request{};
  const protocol::StartRequest start{7, protocol::kSliceStream, 1, 1, 0};
  const auto len = protocol::encode_request(protocol::Command::start, 1, protocol::bytes_of(start), request);
  (void)client.submit_control(0x41, 1, 0, static_cast<std::uint16_t>(len), std::span(request).first(len));
  REQUIRE(client.next_reply()->status == 0);
  const std::size_t expected = make_record(make_wire_slice(0).view()).size();
  std::size_t size = 0;
  std::optional<UsbipClient::Reply> reply;
  do {
    (void)client.submit(1, 1024);
    reply = client.next_reply();
    REQUIRE(reply->status == 0);
    size += reply->data.size();
  } while (reply->data.size() == 1024);
  CHECK(size == expected);
  (void)client.submit(1, 700);
  CHECK(client.next_reply()->status == -EOVERFLOW);
  (void)client.submit(1, 1u << 16);
  reply = client.next_reply();
  CHECK(reply->status == 0);
  protocol::RecordHeader header;
  std::memcpy(&header, reply->data.data(), sizeof header);
  CHECK(header.magic == protocol::kMagic);  // at a record again
  CHECK(header.seq == 2);
}

TEST_CASE("usbip: whatever bytes come, the connection ends or is answered and the next host is served") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1));
  const auto server = serve(loopback.port());
  for (std::uint32_t seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    UsbipClient client(server->tcp_port());
    if (seed % 2 == 0) {
      while (client.import() != 0) {
      }
    }
    std::vector<std::byte> garbage(1 + random() % 300);
    for (std::byte& b : garbage) b = static_cast<std::byte>(random() % 4 == 0 ? random() & 0xFF : random() % 3);
    client.send(garbage);
  }
  UsbipClient last(server->tcp_port());
  CHECK(last.list().size() == 328);
}

TEST_CASE("usbip: the connection may be cut at every byte of a request and of a record, the next host is served") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1u << 30));
  const auto server = serve(loopback.port());
  std::array<std::byte, protocol::kMaxRequestLen> memory{};
  const auto ask = [&](UsbipClient& client, protocol::Command command, std::span<const std::byte> payload) {
    const auto size = protocol::encode_request(command, 1, payload, memory);
    (void)client.submit_control(0x41, 1, 0, static_cast<std::uint16_t>(size), std::span(memory).first(size));
  };
  const std::size_t reply = 48, record = make_record(make_wire_slice(0).view()).size();
  const std::size_t request = 48 + sizeof(protocol::RequestHeader) + sizeof(protocol::StartRequest);
  for (std::size_t cut = 0; cut <= request + reply + record; ++cut) {
    CAPTURE(cut);
    UsbipClient client(server->tcp_port());
    while (client.import() != 0) {  // until the last one's end has come
    }
    ask(client, protocol::Command::stop, {});
    REQUIRE(client.next_reply());
    if (cut < request) client.cut_after(cut);
    ask(client, protocol::Command::start,
        protocol::bytes_of(protocol::StartRequest{7, protocol::kSliceStream, 1, 1, 0}));
    if (cut < request) continue;
    REQUIRE(client.next_reply()->status == 0);
    (void)client.submit(1, 1u << 16);
    REQUIRE(client.receive(cut - request));
  }
  Inbox inbox;
  auto session = open_over(*server);
  REQUIRE(session->start(kLossless, inbox.callbacks()));
  REQUIRE(inbox.wait_for_slices(10));
  session->stop();
  check_closed(session->ledger());
  CHECK(session->ledger().foreign == 0);
}

TEST_CASE("usbip: a device that hangs holds up nothing but its own transfers") {
  HangingPort port;
  const auto server = serve(port);
  UsbipClient client(server->tcp_port());
  REQUIRE(client.import() == 0);
  const std::array<std::byte, 8> request{};
  const auto stream = client.submit(1, 4096);
  const auto control = client.submit_control(0x41, 1, 0, 8, request);
  for (const std::uint32_t seqnum : {stream, control}) {
    (void)client.unlink(seqnum);
    CHECK(client.next_reply()->status == kCancelled);
  }
  UsbipClient other(server->tcp_port());
  CHECK(other.list().size() == 328);
  CHECK(other.import() == 2);
  port.release();
}

TEST_CASE(
    "usbip: a request without a reply waits until the host gives up, a halted stream stalls until it is cleared") {
  TroubledPort port;
  const auto server = serve(port);
  UsbipClient client(server->tcp_port());
  REQUIRE(client.import() == 0);
  const std::array<std::byte, 8> request{};
  for (int round = 0; round < 3; ++round) {
    (void)client.unlink(client.submit_control(0x41, 1, 0, 8, request));
    CHECK(client.next_reply()->status == kCancelled);
    (void)client.submit(1, 4096);
    CHECK(client.next_reply()->status == kStalled);
  }
  (void)client.submit_control(0x00, 9, 1, 0);
  CHECK(client.next_reply()->status == 0);
  (void)client.unlink(client.submit(1, 4096));
  CHECK(client.next_reply()->status == kCancelled);
}

TEST_CASE("usbip: when the device goes, its transfers end as gone and so does the connection") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1));
  const auto server = serve(loopback.port());
  UsbipClient client(server->tcp_port());
  REQUIRE(client.import() == 0);
  (void)client.submit(1, 4096);
  loopback.unplug();
  const auto reply = client.next_reply();
  REQUIRE(reply);
  CHECK(reply->status == -ENODEV);
  CHECK_FALSE(client.next_reply());
}

TEST_CASE("usbip: a TCP port that is taken is named") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1));
  const auto server = serve(loopback.port());
  HangingPort other;
  const auto second = UsbipServer::start(other, kIdentity, server->tcp_port());
  CHECK_FALSE(second.value);
  CHECK(second.error.find(std::to_string(server->tcp_port())) != std::string::npos);
}
