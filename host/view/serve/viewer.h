#pragma once
// Scene -> [VIEWER] -> one page
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <memory>
#include <string>
#include <string_view>

#include "host/view/serve/service.h"

namespace sonoloft::view {

/// A page that is connected. It says "next" when it is done with what it got, and gets one message with all that is new
/// then, at once or as soon as there is something: so it decides how often, and a frozen one costs what one message
/// takes. Threads: the server's.
class Viewer : public std::enable_shared_from_this<Viewer> {
 public:
  Viewer(boost::beast::tcp_stream stream, Service& service);
  ~Viewer();
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  void accept(boost::beast::http::request<boost::beast::http::empty_body> request);
  /// There may be news.
  void wake();

 private:
  void read();
  [[nodiscard]] bool obey(std::string_view word);

  boost::beast::websocket::stream<boost::beast::tcp_stream> stream_;
  Service& service_;
  boost::beast::http::request<boost::beast::http::empty_body> request_;
  boost::beast::flat_buffer buffer_;
  std::string message_;  ///< under way
  Cursor cursor_;
  bool wants_ = false, writing_ = false;
};

}  // namespace sonoloft::view
