#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/igtl/wire/message.h"

// bytes of a client -> [REQUEST READER] -> requests

namespace sonoloft::igtl {

/// A message of a client.
struct Request {
  std::string type, device;
  int version;
  Bytes body;  ///< what is between extended header and metadata, where there are such
  bool sound;  ///< it came whole, and its check sum is right; else body is empty
};

/// Takes the bytes of a client apart. Whatever sizes they state, it keeps no more than kMaxKept of them: longer
/// messages, which nobody here answers, are passed over. Threads: one at a time.
class RequestReader {
 public:
  static constexpr std::uint64_t kMaxKept = 4096;        ///< bytes of a body
  static constexpr std::uint64_t kMaxPassed = 1u << 30;  ///< bytes of a body that is passed over

  /// @return what is complete now, in order; nullopt: this is not OpenIGTLink, or no sane one, and no byte after it can
  ///         be made sense of
  [[nodiscard]] std::optional<std::vector<Request>> take(std::span<const std::byte> bytes);

 private:
  struct Head;
  [[nodiscard]] std::optional<Head> head() const;
  [[nodiscard]] Request request(const Head& head) const;

  Bytes kept_;              ///< of the message at hand
  std::uint64_t pass_ = 0;  ///< bytes to come that are passed over
};

}  // namespace sonoloft::igtl
