#include <algorithm>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "host/view/serve/page_files.h"
#include "host/view/serve/service.h"
#include "host/view/serve/viewer.h"

namespace sonoloft::view {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;

constexpr std::chrono::seconds kPatience{20};

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(boost::asio::ip::tcp::socket socket, Service& service)
      : stream_(std::move(socket)), service_(service) {
    ++service_.connections;
  }
  ~HttpConnection() { --service_.connections; }
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  void read() {
    parser_.emplace();
    parser_->body_limit(0);
    stream_.expires_after(kPatience);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](const beast::error_code& error, std::size_t) {
                       if (!error) self->answer(self->parser_->release());
                     });
  }

 private:
  using Request = http::request<http::empty_body>;

  void answer(Request request) {
    const std::string_view host = view(request[http::field::host]);
    if (!service_.door.admits_host(host)) return refuse(request, http::status::misdirected_request);
    if (beast::websocket::is_upgrade(request)) return upgrade(std::move(request), host);
    if (request.method() != http::verb::get && request.method() != http::verb::head)
      return refuse(request, http::status::method_not_allowed);
    const auto files = page_files();
    const auto file =
        std::find_if(files.begin(), files.end(), [&](const PageFile& f) { return f.path == view(request.target()); });
    if (file == files.end()) return refuse(request, http::status::not_found);
    send(request, http::status::ok, file->type, file->bytes);
  }

  void upgrade(Request request, std::string_view host) {
    if (!service_.door.admits(host, view(request[http::field::origin]), view(request.target()))) {
      ++service_.refused;
      return refuse(request, http::status::forbidden);
    }
    stream_.expires_never();
    std::make_shared<Viewer>(std::move(stream_), service_)->accept(std::move(request));
  }

  void refuse(const Request& request, http::status status) {
    const auto reason = http::obsolete_reason(status);
    send(request, status, "text/plain", view(reason));
  }

  void send(const Request& request, http::status status, std::string_view type, std::string_view bytes) {
    auto& r = response_.emplace(status, request.version());
    const auto set = [&r](auto field, std::string_view value) {
      r.set(field, beast::string_view(value.data(), value.size()));
    };
    set(http::field::content_type, type);
    set(http::field::cache_control, "no-store");
    // Nothing from elsewhere, nothing inline, and no page of others around this one.
    set("Content-Security-Policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
    set("X-Content-Type-Options", "nosniff");
    set("Referrer-Policy", "no-referrer");
    set("Cross-Origin-Resource-Policy", "same-origin");
    set("Cross-Origin-Opener-Policy", "same-origin");
    r.keep_alive(request.keep_alive());
    r.content_length(bytes.size());
    if (request.method() != http::verb::head) r.body() = {const_cast<char*>(bytes.data()), bytes.size(), false};
    serializer_.emplace(*response_);
    http::async_write(stream_, *serializer_, [self = shared_from_this()](const beast::error_code& error, std::size_t) {
      if (!error && self->response_->keep_alive()) self->read();
    });
  }

  beast::tcp_stream stream_;
  Service& service_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::optional<http::response<http::buffer_body>> response_;
  std::optional<http::response_serializer<http::buffer_body>> serializer_;
};

}  // namespace

void serve_http(boost::asio::ip::tcp::socket socket, Service& service) {
  if (service.connections >= Service::kMaxConnections) return;
  std::make_shared<HttpConnection>(std::move(socket), service)->read();
}

}  // namespace sonoloft::view
