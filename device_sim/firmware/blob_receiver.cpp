#include "device_sim/firmware/blob_receiver.h"

#include "protocol/block.h"
#include "protocol/crc32c.h"

namespace sonoloft::device_sim {

using protocol::BlobKind;
using protocol::BlobState;
using protocol::Status;

Status BlobReceiver::begin(const protocol::BeginBlobRequest& wanted) {
  if (store_ == nullptr) return Status::not_implemented;
  forget();
  if (wanted.len == 0 || wanted.len > store_->max_blob()) return Status::invalid_parameter;
  if (!store_->begin(static_cast<BlobKind>(wanted.kind), wanted.len)) return Status::invalid_parameter;
  wanted_ = wanted;
  state_ = BlobState::receiving;
  return Status::ok;
}

void BlobReceiver::take(std::span<const std::byte> bytes) {
  const auto block = protocol::parse_block(bytes);
  if (state_ != BlobState::receiving || !block) return;
  if (block->offset != received_ || block->data.size() > wanted_.len - received_) return;
  if (!store_->write(block->data)) return forget();
  crc32c_ = protocol::crc32c(block->data, crc32c_);
  received_ += static_cast<std::uint32_t>(block->data.size());
  if (received_ < wanted_.len) return;
  state_ = crc32c_ == wanted_.crc32c ? BlobState::complete : BlobState::spoiled;
}

Status BlobReceiver::keep() {
  if (store_ == nullptr) return Status::not_implemented;
  if (state_ == BlobState::kept) return Status::ok;
  if (state_ != BlobState::complete) return Status::wrong_state;
  switch (store_->keep()) {
    case BlobStore::Kept::yes:
      state_ = BlobState::kept;
      return Status::ok;
    case BlobStore::Kept::not_yet:
      return Status::pending;
    case BlobStore::Kept::no:
      break;
  }
  forget();
  return Status::invalid_parameter;
}

void BlobReceiver::give_up() {
  if (state_ != BlobState::kept) forget();
}

void BlobReceiver::forget() {
  wanted_ = {};
  state_ = BlobState::none;
  received_ = crc32c_ = 0;
}

protocol::BlobReply BlobReceiver::status() const {
  return {wanted_.kind, wanted_.len, received_, static_cast<std::uint16_t>(state_), 0};
}

}  // namespace sonoloft::device_sim
