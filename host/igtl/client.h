#pragma once
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "host/igtl/scene/scene.h"
#include "host/igtl/server.h"
#include "host/igtl/wire/request_reader.h"

// Scene -> [CLIENT: what it has, what it wants] <-> TCP

namespace sonoloft::igtl {

/// One connection. Nothing here waits: what a client does not take stays where it is, and when it takes again it gets
/// the newest there is. Threads: one at a time.
class Client {
 public:
  using Clock = std::chrono::steady_clock;
  enum class State : std::uint8_t {
    fine,
    gone,     ///< it closed
    foreign,  ///< what it sends is no OpenIGTLink
    frozen,   ///< it took nothing for longer than the patience, or its machine is away
  };

  /// Owns the socket, which does not block, from now on.
  Client(int socket, Clock::time_point now) : socket_(socket), connected_(now), progress_(now), spoken_(now) {}
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  [[nodiscard]] int socket() const { return socket_; }
  [[nodiscard]] bool wants_to_receive() const;  ///< false: it is to take its answers first
  [[nodiscard]] bool wants_to_send() const { return sending_ != nullptr; }

  /// Some of what came.
  [[nodiscard]] State receive(ServerCounts& counts);
  /// As much as it takes of what it is to get, within reason: others have their turn, too. To be called at every tick.
  [[nodiscard]] State send(const Scene& scene, Clock::time_point now, std::chrono::milliseconds patience,
                           ServerCounts& counts);

 private:
  using Frame = std::shared_ptr<const Bytes>;
  /// Who asks is answered and gets what it asks for, nothing else: programs that ask expect answers only. Who is silent
  /// for a while gets everything.
  enum class Way : std::uint8_t { undecided, asks, listens };

  [[nodiscard]] bool obey(const Request& request);
  void choose_next(const Scene& scene, Clock::time_point now);
  void begin(Frame frame, std::uint64_t ServerCounts::*counted, Clock::time_point now);
  [[nodiscard]] Frame answer(const Scene& scene);
  [[nodiscard]] const Device* asked_surface(const Scene& scene);
  [[nodiscard]] const Device* new_pose(const Scene& scene, Clock::time_point now);
  [[nodiscard]] const Device* new_surface(const Scene& scene);
  [[nodiscard]] Frame status(const std::string& text) const;

  const int socket_;
  const Clock::time_point connected_;
  RequestReader reader_;
  int version_ = 1;  ///< that it is spoken to in
  Way way_ = Way::undecided;

  // Asked for and not answered yet.
  std::size_t statuses_ = 0, confirmations_ = 0;
  std::deque<std::string> surfaces_;  ///< by device name

  std::optional<std::chrono::milliseconds> tdata_interval_;  ///< poses are to come as TDATA
  Clock::time_point last_tdata_{};
  std::uint64_t pose_ = 0;              ///< revision that it has
  std::map<Label, std::uint64_t> has_;  ///< revision of each surface
  Label last_surface_ = 0;              ///< that it got

  Frame sending_;  ///< null: nothing
  std::size_t sent_ = 0;
  std::uint64_t ServerCounts::*counted_ = nullptr;  ///< where it counts when it is sent
  Clock::time_point progress_;                      ///< when something was taken, or there was nothing to take
  Clock::time_point spoken_;                        ///< when something was said last
};

}  // namespace sonoloft::igtl
