#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "protocol/command.h"

namespace sonoloft::device_sim {

/// Where blobs are kept: a board's flash. Called by the firmware, one call at a time; none may wait.
class BlobStore {
 public:
  enum class Kept : std::uint8_t { yes, not_yet, no };

  [[nodiscard]] virtual std::uint32_t max_blob() const = 0;  ///< bytes
  /// Makes room beside the blob that is kept. @return false: no blob of this kind is taken
  [[nodiscard]] virtual bool begin(protocol::BlobKind kind, std::uint32_t len) = 0;
  /// Bytes after those of before. @return false: they could not be stored
  [[nodiscard]] virtual bool write(std::span<const std::byte> bytes) = 0;
  /// All of it came: keeps it in place of the old one. no: it is not what it should be; not_yet: asked too early.
  [[nodiscard]] virtual Kept keep() = 0;

 protected:
  ~BlobStore() = default;
};

/// Takes a blob in blocks, in order; a block that is not the next one, or was altered, is as good as lost, and the host
/// sees it from BlobReply::received. Threads: one at a time.
class BlobReceiver {
 public:
  /// A transfer of at most this many bytes is one block.
  static constexpr std::uint32_t kMaxBlock = 4096;

  /// @param store  nullptr: no blob is ever begun
  explicit BlobReceiver(BlobStore* store) : store_(store) {}

  [[nodiscard]] protocol::Status begin(const protocol::BeginBlobRequest& wanted);
  void take(std::span<const std::byte> block);
  /// Repeated after an ok it is ok again: a reply may get lost.
  [[nodiscard]] protocol::Status keep();
  /// Gives up what is not kept.
  void give_up();
  [[nodiscard]] protocol::BlobReply status() const;
  [[nodiscard]] std::uint32_t max_blob() const { return store_ == nullptr ? 0 : store_->max_blob(); }

 private:
  void forget();

  BlobStore* const store_;
  protocol::BeginBlobRequest wanted_{};
  protocol::BlobState state_ = protocol::BlobState::none;
  std::uint32_t received_ = 0, crc32c_ = 0;
};

}  // namespace sonoloft::device_sim
