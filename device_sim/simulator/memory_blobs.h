#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "device_sim/firmware/blob_receiver.h"

namespace sonoloft::device_sim {

/// A board's flash, in memory: a blob of each kind. Like flash it takes a moment: the first question whether a blob is
/// kept is answered with not_yet.
class MemoryBlobs final : public BlobStore {
 public:
  ~MemoryBlobs() = default;
  [[nodiscard]] std::uint32_t max_blob() const override { return 16u << 20; }
  [[nodiscard]] bool begin(protocol::BlobKind kind, std::uint32_t) override {
    arriving_.clear();
    kind_ = kind;
    asked_ = false;
    return kind == protocol::BlobKind::firmware || kind == protocol::BlobKind::calibration;
  }
  [[nodiscard]] bool write(std::span<const std::byte> bytes) override {
    arriving_.insert(arriving_.end(), bytes.begin(), bytes.end());
    return true;
  }
  [[nodiscard]] Kept keep() override {
    if (!std::exchange(asked_, true)) return Kept::not_yet;
    kept_[kind_ == protocol::BlobKind::firmware ? 0 : 1] = arriving_;
    return Kept::yes;
  }

  /// Empty: there is none. @pre the firmware is not at work
  [[nodiscard]] const std::vector<std::byte>& kept(protocol::BlobKind kind) const {
    return kept_[kind == protocol::BlobKind::firmware ? 0 : 1];
  }

 private:
  std::array<std::vector<std::byte>, 2> kept_;
  std::vector<std::byte> arriving_;
  protocol::BlobKind kind_{};
  bool asked_ = false;
};

}  // namespace sonoloft::device_sim
