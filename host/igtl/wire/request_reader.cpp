#include "host/igtl/wire/request_reader.h"

#include <igtl_header.h>

#include <algorithm>
#include <cstring>

namespace sonoloft::igtl {
namespace {

constexpr std::size_t kExtendedLen = 12;

/// Text of a field that zeros fill up.
template <std::size_t N>
std::string text(const char (&field)[N]) {
  return {field, std::find(field, field + N, '\0')};
}

bool printable(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c <= '~'; });
}

std::uint64_t big_endian(std::span<const std::byte> bytes) {
  std::uint64_t value = 0;
  for (const std::byte byte : bytes) value = value << 8 | static_cast<std::uint64_t>(byte);
  return value;
}

/// What lies between extended header and metadata; nullopt where their sizes do not fit.
std::optional<std::span<const std::byte>> content(std::span<const std::byte> body) {
  if (body.size() < kExtendedLen) return std::nullopt;
  const std::uint64_t before = big_endian(body.first(2));
  const std::uint64_t after = big_endian(body.subspan(2, 2)) + big_endian(body.subspan(4, 4));
  if (before < kExtendedLen || before + after > body.size()) return std::nullopt;
  return body.subspan(before, body.size() - before - after);
}

}  // namespace

struct RequestReader::Head {
  std::string type, device;
  int version;
  std::uint64_t body_len, crc;
};

std::optional<std::vector<Request>> RequestReader::take(std::span<const std::byte> bytes) {
  std::vector<Request> requests;
  for (;;) {
    const std::uint64_t passed = std::min<std::uint64_t>(pass_, bytes.size());
    pass_ -= passed;
    bytes = bytes.subspan(passed);

    std::optional<Head> known;
    if (kept_.size() >= kHeaderLen) known = head();
    const std::uint64_t wanted = kHeaderLen + (known ? known->body_len : 0);
    const std::uint64_t taken = std::min<std::uint64_t>(wanted - kept_.size(), bytes.size());
    kept_.insert(kept_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(taken));
    bytes = bytes.subspan(taken);
    if (kept_.size() < wanted) return requests;
    if (!known) {
      known = head();
      if (!known) return std::nullopt;
      if (known->body_len > 0 && known->body_len <= kMaxKept) continue;
    }
    requests.push_back(request(*known));
    if (known->body_len > kMaxKept) pass_ = known->body_len;
    kept_.clear();
  }
}

/// nullopt: it makes no sense
std::optional<RequestReader::Head> RequestReader::head() const {
  constexpr int kHighestVersion = 255;  // two are known; a text's first letters are none
  igtl_header header;
  std::memcpy(&header, kept_.data(), sizeof header);
  igtl_header_convert_byte_order(&header);
  Head head{text(header.name), text(header.device_name), header.version, header.body_size, header.crc};
  if (head.version < 1 || head.version > kHighestVersion) return std::nullopt;
  if (!printable(head.type) || head.body_len > kMaxPassed) return std::nullopt;
  return head;
}

Request RequestReader::request(const Head& head) const {
  Request request{head.type, head.device, head.version, {}, false};
  const auto body = std::span(kept_).subspan(kHeaderLen);
  if (body.size() != head.body_len) return request;
  if (!body.empty() && crc(body.data(), body.size()) != head.crc) return request;
  const auto inner = head.version >= 2 && !body.empty() ? content(body) : body;
  if (!inner) return request;
  request.body.assign(inner->begin(), inner->end());
  request.sound = true;
  return request;
}

}  // namespace sonoloft::igtl
