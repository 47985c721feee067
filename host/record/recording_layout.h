#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "host/record/mcap/mcap_writer.h"

// What is where in a recording; docs/recordings.md has it in words.

namespace sonoloft::record {

inline constexpr const char* kProfile = "x-sonoloft";

/// Channels of the file, and their topics.
enum class Topic : std::uint16_t { slices = 1, transfers, requests, stream, events };
[[nodiscard]] const char* name(Topic topic);

/// Profile, schemas and channels of every recording.
[[nodiscard]] mcap::Opening opening();

/// A message of `slices` begins with the record's payload, so that whoever knows the schema can read it, and ends with
/// the record's header: the record's bytes from here on, then those before.
inline constexpr std::size_t kSliceHeaderLen = 64;
/// Only such records are turned around: of a slice, their payload unaltered. All else goes to `transfers`.
/// @pre transfer.data() is 16-byte aligned
[[nodiscard]] bool is_sound_slice(std::span<const std::byte> transfer);

}  // namespace sonoloft::record
