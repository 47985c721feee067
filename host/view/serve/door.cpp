#include "host/view/serve/door.h"

#include <array>
#include <cstddef>
#include <cstdio>
#include <random>

namespace sonoloft::view {
namespace {

std::string random_token() {
  std::random_device random;
  std::string token;
  for (int i = 0; i < 4; ++i) {
    std::array<char, 9> digits{};
    std::snprintf(digits.data(), digits.size(), "%08x", random());
    token += digits.data();
  }
  return token;
}

std::string in_brackets(std::string_view address) {
  const bool v6 = address.find(':') != std::string_view::npos;
  return v6 ? '[' + std::string(address) + ']' : std::string(address);
}

/// In a time that does not tell where they differ.
bool equal(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  int difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= a[i] ^ b[i];
  return difference == 0;
}

}  // namespace

Door::Door(std::string_view address, bool loopback, std::uint16_t port)
    : port_(':' + std::to_string(port)),
      own_host_(in_brackets(address) + port_),
      token_(loopback ? "" : random_token()) {}

bool Door::admits_host(std::string_view host) const {
  if (!token_.empty()) return true;
  return host == own_host_ || host == "localhost" + port_ || host == "127.0.0.1" + port_ || host == "[::1]" + port_;
}

bool Door::admits(std::string_view host, std::string_view origin, std::string_view target) const {
  const std::string wanted = token_.empty() ? "/scene" : "/scene?token=" + token_;
  return admits_host(host) && origin == "http://" + std::string(host) && equal(target, wanted);
}

std::string Door::url(std::string_view host_name) const {
  const std::string page = "http://" + (host_name.empty() ? own_host_ : std::string(host_name) + port_) + '/';
  return token_.empty() ? page : page + "#token=" + token_;
}

}  // namespace sonoloft::view
