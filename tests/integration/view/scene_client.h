#pragma once
// ViewServer -> [SCENE CLIENT] -> what a page would get
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/octree/brick.h"

namespace sonoloft::test {

struct Surface {
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<std::int8_t, 4>> shades;  ///< normal, measured
  std::vector<std::uint8_t> distances;             ///< quarters of a mm
  std::vector<std::uint32_t> indices;
};
using Surfaces = std::map<std::uint32_t, Surface>;  ///< by label

struct SceneMessage {
  nlohmann::json head;
  std::map<BrickCoord, Surfaces> bricks;
  std::size_t bytes = 0;
};

/// What a server answers to a request in plain text, its header lines included; empty when it hangs up.
[[nodiscard]] std::string answer_to(std::uint16_t port, const std::string& request);
/// A request to see the scene, as a browser would make it.
[[nodiscard]] std::string upgrade_request(const std::string& host, const std::string& origin,
                                          const std::string& target = "/scene");

/// A viewer on the loopback address, without a browser.
class SceneClient {
 public:
  explicit SceneClient(std::uint16_t port);
  ~SceneClient();

  void say(const std::string& word);
  /// Waits for a message, asking for none. Empty where the server has hung up.
  [[nodiscard]] std::unique_ptr<SceneMessage> read();
  /// Asks and waits, until the server says that nothing is missing; what came is put together.
  [[nodiscard]] SceneMessage catch_up();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sonoloft::test
