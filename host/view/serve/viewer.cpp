#include "host/view/serve/viewer.h"

#include <boost/asio/buffer.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <utility>

namespace sonoloft::view {
namespace {

namespace beast = boost::beast;
namespace websocket = beast::websocket;

constexpr std::size_t kLongestWord = 64;

websocket::stream_base::timeout patience() {
  return {std::chrono::seconds(20), std::chrono::seconds(60), true};
}

}  // namespace

Viewer::Viewer(beast::tcp_stream stream, Service& service) : stream_(std::move(stream)), service_(service) {
  ++service_.connections;
  ++service_.viewer_count;
}

Viewer::~Viewer() {
  --service_.viewer_count;
  --service_.connections;
}

void Viewer::accept(beast::http::request<beast::http::empty_body> request) {
  request_ = std::move(request);
  stream_.set_option(patience());
  stream_.read_message_max(kLongestWord);
  stream_.binary(true);
  stream_.async_accept(request_, [self = shared_from_this()](const beast::error_code& error) {
    if (error) return;
    self->service_.viewers.push_back(self);
    self->read();
  });
}

void Viewer::read() {
  buffer_.clear();
  stream_.async_read(buffer_, [self = shared_from_this()](const beast::error_code& error, std::size_t) {
    if (error) return;
    if (!self->obey(beast::buffers_to_string(self->buffer_.data()))) {
      self->stream_.async_close(websocket::close_code::policy_error, [self](const beast::error_code&) {});
      return;
    }
    self->wake();
    self->read();
  });
}

bool Viewer::obey(std::string_view word) {
  if (word == "next") {
    wants_ = true;
  } else if (word == "stop" && service_.source.stop) {
    service_.source.stop();
  } else if ((word == "record" || word == "record-end") && service_.source.record) {
    service_.source.record(word == "record");
  } else if (word == "measured" && service_.source.confidence) {
    cursor_.measured = true;
    cursor_.bricks = 0;  // all bricks anew, with their confidence
  } else if (word == "labels") {
    cursor_.measured = false;
  } else if (word == "coverage" && service_.source.coverage) {
    cursor_.coverage = true;
  } else {
    return false;
  }
  return true;
}

void Viewer::wake() {
  if (!wants_ || writing_ || !service_.scene.has_news(cursor_)) return;
  const std::uint64_t before = cursor_.bricks_sent;
  message_ = service_.scene.message(cursor_);
  wants_ = false;
  writing_ = true;
  service_.bricks_sent += cursor_.bricks_sent - before;
  service_.bytes_sent += message_.size();
  ++service_.messages_sent;
  stream_.async_write(boost::asio::buffer(message_),
                      [self = shared_from_this()](const beast::error_code& error, std::size_t) {
                        self->writing_ = false;
                        self->message_ = {};
                        if (!error) self->wake();
                      });
}

}  // namespace sonoloft::view
