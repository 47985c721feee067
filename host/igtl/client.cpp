#include "host/igtl/client.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "host/igtl/wire/message_bodies.h"

namespace sonoloft::igtl {
namespace {

constexpr std::size_t kMaxAsked = 16;           // questions that may wait for their answers
constexpr int kMaxAtOnce = 16;                  // messages
constexpr std::chrono::seconds kSilence{1};     // after which a client is one that listens
constexpr std::chrono::seconds kSignOfLife{2};  // is sent when there was nothing else

Client::State state_after(int error) {
  if (error == EAGAIN || error == EINTR) return Client::State::fine;
  return error == ETIMEDOUT ? Client::State::frozen : Client::State::gone;
}

}  // namespace

Client::~Client() {
  close(socket_);
}

bool Client::wants_to_receive() const {
  return statuses_ + confirmations_ + surfaces_.size() < kMaxAsked;
}

// ---- what comes

Client::State Client::receive(ServerCounts& counts) {
  std::array<std::byte, 4096> bytes;
  const ssize_t size = recv(socket_, bytes.data(), bytes.size(), 0);
  if (size < 0) return state_after(errno);
  if (size == 0) return State::gone;
  const auto requests = reader_.take(std::span(bytes).first(static_cast<std::size_t>(size)));
  if (!requests) return State::foreign;
  for (const Request& request : *requests) {
    version_ = std::max(version_, std::min(request.version, 2));
    counts.ignored += request.sound && obey(request) ? 0 : 1;
  }
  return State::fine;
}

/// @return false: there is no answer to this
bool Client::obey(const Request& request) {
  bool asks = true;
  if (request.type == "GET_POLYDATA") {
    surfaces_.push_back(request.device);
  } else if (request.type == "STT_TDATA") {
    const auto interval = tdata_interval(request.body);
    if (!interval) return false;
    tdata_interval_ = interval;
    pose_ = 0;
    ++confirmations_;
  } else if (request.type == "STP_TDATA") {
    tdata_interval_.reset();
    ++confirmations_;
  } else if (request.type == "GET_STATUS") {
    ++statuses_;
    asks = false;
  } else {
    return request.type == "STATUS";  // a sign of life
  }
  if (asks && way_ == Way::undecided) way_ = Way::asks;
  return true;
}

// ---- what goes

Client::State Client::send(const Scene& scene, Clock::time_point now, std::chrono::milliseconds patience,
                           ServerCounts& counts) {
  if (way_ == Way::undecided && now - connected_ >= kSilence) way_ = Way::listens;
  for (int i = 0; i < kMaxAtOnce; ++i) {
    if (!sending_) choose_next(scene, now);
    if (!sending_) break;
    const auto rest = std::span(*sending_).subspan(sent_);
    const ssize_t size = ::send(socket_, rest.data(), rest.size(), MSG_NOSIGNAL);
    if (size < 0) {
      const State state = state_after(errno);
      return state == State::fine && now - progress_ >= patience ? State::frozen : state;
    }
    progress_ = now;
    sent_ += static_cast<std::size_t>(size);
    if (sent_ < sending_->size()) continue;
    if (counted_ != nullptr) ++(counts.*counted_);
    sending_.reset();
  }
  progress_ = now;
  return State::fine;
}

void Client::choose_next(const Scene& scene, Clock::time_point now) {
  if (auto frame = answer(scene)) return begin(std::move(frame), nullptr, now);
  if (const Device* asked = asked_surface(scene)) return begin(asked->frame(version_), &ServerCounts::surfaces, now);
  if (const Device* pose = new_pose(scene, now)) {
    pose_ = pose->revision();
    if (tdata_interval_) last_tdata_ = now;
    return begin(pose->frame(version_), &ServerCounts::poses, now);
  }
  if (const Device* surface = new_surface(scene)) return begin(surface->frame(version_), &ServerCounts::surfaces, now);
  const bool follows = way_ == Way::listens || tdata_interval_;
  if (follows && now - spoken_ >= kSignOfLife) begin(status(scene.said()), nullptr, now);
}

void Client::begin(Frame frame, std::uint64_t ServerCounts::*counted, Clock::time_point now) {
  sending_ = std::move(frame);
  counted_ = counted;
  sent_ = 0;
  spoken_ = now;
}

Client::Frame Client::answer(const Scene& scene) {
  if (confirmations_ > 0) {
    --confirmations_;
    const Message done{"RTS_TDATA", "SonoLoft", std::chrono::system_clock::now(), rts_tdata_body()};
    return std::make_shared<const Bytes>(framed(done, version_));
  }
  if (statuses_ == 0) return nullptr;
  --statuses_;
  return status(scene.said());
}

Client::Frame Client::status(const std::string& text) const {
  const Message message{"STATUS", "SonoLoft", std::chrono::system_clock::now(), status_body(text)};
  return std::make_shared<const Bytes>(framed(message, version_));
}

/// The device that was asked for by its name; else the one after that which it got last. A question that comes before
/// the first mesh waits for it.
const Device* Client::asked_surface(const Scene& scene) {
  const auto& all = scene.surfaces();
  if (surfaces_.empty() || all.empty()) return nullptr;
  auto chosen =
      std::find_if(all.begin(), all.end(), [&](const auto& entry) { return entry.second.name() == surfaces_.front(); });
  surfaces_.pop_front();
  if (chosen == all.end()) chosen = all.upper_bound(last_surface_);
  if (chosen == all.end()) chosen = all.begin();
  last_surface_ = chosen->first;
  return &chosen->second;
}

const Device* Client::new_pose(const Scene& scene, Clock::time_point now) {
  const Device& pose = tdata_interval_ ? scene.tdata() : scene.transform();
  if (!tdata_interval_ && way_ != Way::listens) return nullptr;
  if (tdata_interval_ && now - last_tdata_ < *tdata_interval_) return nullptr;
  return pose.revision() > pose_ ? &pose : nullptr;
}

/// The next after the one that it got last which it has not as it is now.
const Device* Client::new_surface(const Scene& scene) {
  if (way_ != Way::listens) return nullptr;
  const auto& all = scene.surfaces();
  auto next = all.upper_bound(last_surface_);
  for (std::size_t i = 0; i < all.size(); ++i, ++next) {
    if (next == all.end()) next = all.begin();
    const auto& [label, surface] = *next;
    if (has_[label] == surface.revision()) continue;
    has_[label] = surface.revision();
    last_surface_ = label;
    return &surface;
  }
  return nullptr;
}

}  // namespace sonoloft::igtl
