#pragma once
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

// A client that knows the bytes from the protocol's document alone, and may do what no decent one does.

namespace sonoloft::test {

using Bytes = std::vector<std::byte>;

/// CRC-64 of ECMA-182, bit by bit.
[[nodiscard]] std::uint64_t ecma_crc(std::span<const std::byte> bytes);

void append_big_endian(Bytes& bytes, std::uint64_t value, int size);
[[nodiscard]] std::uint64_t big_endian(std::span<const std::byte> bytes, std::size_t at, std::size_t size);

/// A whole message; with an extended header and no metadata from version 2 on.
[[nodiscard]] Bytes message(const std::string& type, const std::string& device, const Bytes& content = {},
                            int version = 1);

struct Received {
  int version;
  std::string type, device;
  std::uint64_t timestamp;
  Bytes content;  ///< without extended header and metadata
};

/// Takes a message apart and checks all of its header. @param rest  what comes after it
[[nodiscard]] std::optional<Received> parse(std::span<const std::byte> bytes, std::size_t& size);

/// The content of a POLYDATA with points, triangles and one scalar a point.
struct Polydata {
  std::vector<std::array<float, 3>> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::string scalars;
  std::vector<float> values;
};
[[nodiscard]] Polydata polydata(std::span<const std::byte> content);
[[nodiscard]] float big_endian_float(std::span<const std::byte> bytes, std::size_t at);

/// A connection to 127.0.0.1.
class IgtlClient {
 public:
  /// @param receive_buffer  bytes that the kernel takes for a client that does not read; 0: as it likes
  explicit IgtlClient(std::uint16_t port, int receive_buffer = 0);
  ~IgtlClient();
  IgtlClient(const IgtlClient&) = delete;
  IgtlClient& operator=(const IgtlClient&) = delete;

  /// @return false: the other end has closed
  bool send(std::span<const std::byte> bytes);
  bool ask(const std::string& type, const std::string& device = "", const Bytes& content = {}, int version = 1) {
    return send(message(type, device, content, version));
  }
  /// The next message; nullopt: none came within the limit, or the other end has closed.
  std::optional<Received> receive(std::chrono::milliseconds limit = std::chrono::seconds(60));
  /// The next message of this type; others are passed over.
  std::optional<Received> receive(const std::string& type);
  /// Waits for the other end to close.
  bool closed();
  /// Ends the connection with a reset, as a program does that dies with data unread.
  void vanish();

 private:
  int socket_;
  Bytes received_;
};

}  // namespace sonoloft::test
