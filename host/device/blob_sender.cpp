#include "host/device/blob_sender.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "protocol/block.h"
#include "protocol/crc32c.h"

namespace sonoloft::device {

using protocol::BlobReply;
using protocol::BlobState;
using protocol::Command;

namespace {

constexpr std::chrono::milliseconds kBlockPatience{1000};
constexpr std::chrono::seconds kKeepPatience{60};  // flash is slow
constexpr std::size_t kBlocksAtOnce = 64;
constexpr int kFruitlessRounds = 5;
constexpr int kAttempts = 2;

class BlobSender {
 public:
  BlobSender(Transport& transport, Requester& requester, BlobKind kind, std::span<const std::byte> bytes,
             std::size_t max_block)
      : transport_(transport),
        requester_(requester),
        begin_{static_cast<std::uint32_t>(kind), static_cast<std::uint32_t>(bytes.size()), protocol::crc32c(bytes), 0},
        bytes_(bytes),
        data_len_(max_block - protocol::kMaxBlockOverhead),
        block_(max_block) {}

  Result<void> send() {
    for (int attempt = 1;; ++attempt) {
      if (auto begun = requester_.tell(Command::begin_blob, protocol::bytes_of(begin_)); !begun) return begun;
      const auto reached = send_all();
      if (!reached) return tl::unexpected<Error>(reached.error());
      if (*reached == BlobState::complete) break;
      if (attempt == kAttempts) return nothing_arrives("its sum does not fit");
    }
    return requester_.tell(Command::keep_blob, {}, kKeepPatience);
  }

 private:
  // The state in which all bytes have come.
  Result<BlobState> send_all() {
    std::uint32_t received = 0;
    for (int fruitless = 0; fruitless < kFruitlessRounds;) {
      if (auto sent = send_some(received); !sent) return tl::unexpected<Error>(sent.error());
      const auto reply = requester_.ask<BlobReply>(Command::get_blob);
      if (!reply) return tl::unexpected<Error>(reply.error());
      const auto state = static_cast<BlobState>(reply->state);
      if (state == BlobState::complete || state == BlobState::spoiled) return state;
      if (state != BlobState::receiving) return nothing_arrives("the device gave it up");
      fruitless = reply->received > received ? 0 : fruitless + 1;
      received = reply->received;
    }
    return nothing_arrives("block after block gets lost");
  }

  // A block that fails is as good as one that was lost; but for a device that is gone.
  Result<void> send_some(std::size_t from) {
    for (std::size_t i = 0; i < kBlocksAtOnce && from < bytes_.size(); ++i) {
      const auto data = bytes_.subspan(from, std::min(data_len_, bytes_.size() - from));
      const std::size_t len = protocol::encode_block({static_cast<std::uint32_t>(from), data}, block_);
      auto sent = transport_.send_block(std::span<const std::byte>(block_).first(len), kBlockPatience);
      const bool lost =
          !sent && (sent.error().code == ErrorCode::timed_out || sent.error().code == ErrorCode::io_failed);
      if (lost) return {};
      if (!sent) return sent;
      from += data.size();
    }
    return {};
  }

  static tl::unexpected<Error> nothing_arrives(const std::string& why) {
    return fail(ErrorCode::io_failed, "the blob does not arrive: " + why + ": check the cable and send it again");
  }

  Transport& transport_;
  Requester& requester_;
  const protocol::BeginBlobRequest begin_;
  const std::span<const std::byte> bytes_;
  const std::size_t data_len_;
  std::vector<std::byte> block_;
};

}  // namespace

Result<void> send_blob(Transport& transport, Requester& requester, BlobKind kind, std::span<const std::byte> bytes,
                       std::size_t max_block) {
  return BlobSender(transport, requester, kind, bytes, max_block).send();
}

}  // namespace sonoloft::device
