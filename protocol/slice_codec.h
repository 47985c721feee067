#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "protocol/slice.h"

// Both directions of a slice's payload (a FlatBuffer, see slice.fbs).
//   acquired slice -> [ENCODE] -> record -> bus -> accept -> [DECODE] -> slice

namespace sonoloft::protocol {

/// What one slice may hold; negotiated with GET_INFO.
struct SliceLimits {
  std::uint32_t max_points = 0;  ///< of all contours together; the field of view may have as many again
  std::uint32_t max_contours = 0;
  WireLabel max_label = 0;
  std::uint32_t max_mask_runs = 0;  ///< 0: no masks
  std::uint32_t max_mask_pixels = 0;
};

/// Why a slice means nothing. The first rule that it breaks, in this order.
enum class SliceFault : std::uint8_t {
  none,
  too_many,        ///< over one of the limits
  non_finite,      ///< NaN or infinity in a point, the pose or its error estimate
  quaternion,      ///< | |q| - 1 | > 1e-3
  pose_status,     ///< a status that this version does not know
  short_contour,   ///< fewer than 3 points
  not_contiguous,  ///< the contours do not use the points one after the other, each exactly once
  bad_label,       ///< over max_label and not unknown; 0 without being a hole; an unknown flag
  field_of_view,   ///< 1 or 2 points
  mask,            ///< contours beside it, a grid that is none, or runs that do not fill it
};

/// Checks a slice against the rules of protocol/slice.h. @cost O(#V + #C + #F + #R)
[[nodiscard]] SliceFault check_slice(const Slice& slice, const SliceLimits& limits);

/// A number of bytes that the record of the slice, or of any within the limits, never exceeds: header, payload,
/// padding, trailer.
[[nodiscard]] std::uint64_t max_record_len(const Slice& slice);
[[nodiscard]] std::uint64_t max_record_len(const SliceLimits& limits);

/// What the sender of a record says about it, beside the slice itself.
struct RecordInfo {
  std::uint64_t seq = 0;
  std::uint32_t session_id = 0;
  std::uint8_t minor = 0;  ///< the negotiated one
};

/// Writes the record of a slice, complete but for what is known only when it leaves (see seal_record()).
/// @pre    record.data() is 64-byte aligned
/// @return the record's length; 0 where the buffer is shorter than max_record_len() of this slice: nothing is usable
/// @post   the length is no multiple of 64
/// @cost   O(#V + #C + #F + #R), two passes over the bytes; no heap
[[nodiscard]] std::size_t encode_slice(const Slice& slice, const RecordInfo& info, std::span<std::byte> record);

/// Fills in what changes while a record waits in the ring, and the sum over the header.
/// @pre `record` was written by encode_slice()
void seal_record(std::span<std::byte> record, std::uint32_t device_dropped_total, std::uint16_t ring_used,
                 std::uint16_t ring_capacity);

/// Views into a payload. Time stays 0: it is in the header.
/// @pre    payload.data() is 16-byte aligned
/// @return false where the bytes are no such FlatBuffer (depth 4, 16 tables); nothing outside of payload is read
/// @cost   O(1)
[[nodiscard]] bool decode_slice(std::span<const std::byte> payload, Slice& slice);

}  // namespace sonoloft::protocol
