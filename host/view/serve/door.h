#pragma once
// request -> [DOOR] -> may it come in?
#include <cstdint>
#include <string>
#include <string_view>

namespace sonoloft::view {

/// Who may see the scene. On a loopback address: requests for this machine by a name that only it has, which keeps out
/// names of others that were made to point here (DNS rebinding). On any other address: whoever has the token. On both:
/// pages of this server only.
class Door {
 public:
  Door(std::string_view address, bool loopback, std::uint16_t port);

  /// @param host  as the request's header says it
  [[nodiscard]] bool admits_host(std::string_view host) const;
  /// For the scene itself. @param target  "/scene", or "/scene?token=..."
  [[nodiscard]] bool admits(std::string_view host, std::string_view origin, std::string_view target) const;

  /// Where the page is, with the token.
  [[nodiscard]] std::string url(std::string_view host_name) const;

 private:
  std::string port_;
  std::string own_host_;  ///< the address with the port
  std::string token_;     ///< 128 random bits as hexadecimal digits; empty on loopback
};

}  // namespace sonoloft::view
