#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/slice/result.h"
#include "host/device/requester.h"
#include "host/device/transport.h"
#include "protocol/command.h"

// file -> bytes -> [BLOB SENDER] -> blocks -> device

namespace sonoloft::device {

using protocol::BlobKind;

/// Sends a blob and has the device keep it. What gets lost on the way is sent again, from where the device says that it
/// is; a blob whose sum does not fit is sent anew, once.
/// @pre   no stream runs; max_block > kMaxBlockOverhead
/// @error refused_by_device (it takes no such blob), io_failed (nothing arrives), not_available, transport_closed,
///        timed_out, wrong_state
/// @cost  a GET_BLOB for every 64 blocks
[[nodiscard]] Result<void> send_blob(Transport& transport, Requester& requester, BlobKind kind,
                                     std::span<const std::byte> bytes, std::size_t max_block);

}  // namespace sonoloft::device
