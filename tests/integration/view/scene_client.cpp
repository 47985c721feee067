#include "tests/integration/view/scene_client.h"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>

namespace sonoloft::test {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;

tcp::endpoint at(std::uint16_t port) {
  return {asio::ip::address_v4::loopback(), port};
}

class Reader {
 public:
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}
  template <class T>
  T one() {
    return many<T>(1).front();
  }
  template <class T>
  std::vector<T> many(std::size_t count) {
    std::vector<T> values(count);
    const std::string piece = bytes_.substr(at_, count * sizeof(T));
    std::copy(piece.begin(), piece.end(), reinterpret_cast<char*>(values.data()));
    at_ += count * sizeof(T);
    return values;
  }
  [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }

 private:
  const std::string& bytes_;
  std::size_t at_ = 0;
};

Surfaces read_surfaces(Reader& reader) {
  Surfaces surfaces;
  for (auto labels = reader.one<std::uint32_t>(); labels > 0; --labels) {
    const auto label = reader.one<std::uint32_t>(), vertices = reader.one<std::uint32_t>(),
               indices = reader.one<std::uint32_t>();
    Surface& surface = surfaces[label];
    surface.positions = reader.many<std::array<float, 3>>(vertices);
    surface.shades = reader.many<std::array<std::int8_t, 4>>(vertices);
    surface.distances = reader.many<std::uint8_t>((vertices + 3) / 4 * 4);
    surface.distances.resize(vertices);
    surface.indices = reader.many<std::uint32_t>(indices);
  }
  return surfaces;
}

SceneMessage decode(const std::string& bytes) {
  Reader reader(bytes);
  SceneMessage message;
  message.bytes = bytes.size();
  const auto text = reader.many<char>(reader.one<std::uint32_t>());
  message.head = nlohmann::json::parse(text.begin(), text.end());
  const auto& slice = message.head["slice"];
  const std::size_t points =
      message.head["path"]["points"].get<std::size_t>() + (slice.is_null() ? 0 : slice["points"].get<std::size_t>());
  static_cast<void>(reader.many<float>(3 * points));
  for (std::size_t i = message.head["bricks"]["here"]; i > 0; --i) {
    const auto c = reader.one<std::array<std::int32_t, 3>>();
    message.bricks[{c[0], c[1], c[2]}] = read_surfaces(reader);
  }
  if (!reader.at_end()) throw std::runtime_error("a message is longer than what it holds");
  return message;
}

}  // namespace

std::string answer_to(std::uint16_t port, const std::string& request) {
  asio::io_context io;
  tcp::socket socket(io);
  socket.connect(at(port));
  boost::system::error_code error;
  asio::write(socket, asio::buffer(request), error);
  std::string answer;
  std::array<char, 4096> piece{};
  while (answer.find("\r\n\r\n") == std::string::npos && !error)
    answer.append(piece.data(), socket.read_some(asio::buffer(piece), error));
  return answer;
}

std::string upgrade_request(const std::string& host, const std::string& origin, const std::string& target) {
  return "GET " + target + " HTTP/1.1\r\nHost: " + host + "\r\n" +
         (origin.empty() ? "" : "Origin: " + origin + "\r\n") +
         "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
         "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n";
}

struct SceneClient::State {
  asio::io_context io;
  beast::websocket::stream<tcp::socket> stream{io};
};

SceneClient::SceneClient(std::uint16_t port) : state_(std::make_unique<State>()) {
  const std::string host = "127.0.0.1:" + std::to_string(port);
  auto& stream = state_->stream;
  stream.next_layer().connect(at(port));
  stream.set_option(beast::websocket::stream_base::decorator(
      [host](beast::websocket::request_type& request) { request.set(beast::http::field::origin, "http://" + host); }));
  stream.read_message_max(std::size_t{64} << 20);
  stream.handshake(host, "/scene");
}

SceneClient::~SceneClient() = default;

void SceneClient::say(const std::string& word) {
  state_->stream.write(asio::buffer(word));
}

std::unique_ptr<SceneMessage> SceneClient::read() {
  beast::flat_buffer buffer;
  boost::system::error_code error;
  state_->stream.read(buffer, error);
  if (error) return nullptr;
  return std::make_unique<SceneMessage>(decode(beast::buffers_to_string(buffer.data())));
}

SceneMessage SceneClient::catch_up() {
  SceneMessage all;
  for (bool more = true; more;) {
    say("next");
    const auto message = read();
    if (!message) throw std::runtime_error("the server has hung up");
    for (const auto& [coord, surfaces] : message->bricks) all.bricks[coord] = surfaces;
    all.bytes += message->bytes;
    all.head = message->head;
    more = all.head["bricks"]["more"];
  }
  return all;
}

}  // namespace sonoloft::test
