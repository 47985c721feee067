#include "protocol/slice_codec.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "protocol/crc32c.h"
#include "protocol/record.h"
#include "protocol/schema_hash.h"
#include "protocol/slice_generated.h"

namespace sonoloft::protocol {
namespace {

// The schema's structs are read in place as ours.
static_assert(sizeof(Point) == sizeof(wire::Point) && alignof(Point) == alignof(wire::Point));
static_assert(sizeof(Contour) == sizeof(wire::Contour) && alignof(Contour) == alignof(wire::Contour));
static_assert(offsetof(Contour, first) == 0 && offsetof(Contour, count) == 4 && offsetof(Contour, label) == 8 &&
              offsetof(Contour, flags) == 10);
static_assert(sizeof(MaskRun) == sizeof(wire::MaskRun) && offsetof(MaskRun, count) == 0 &&
              offsetof(MaskRun, label) == 2);
// No vector has elements that need more than 4 bytes of alignment: the verifier would not notice.
static_assert(alignof(Point) <= 4 && alignof(Contour) <= 4 && alignof(MaskRun) <= 4);

// Table, vtable, pose, grid, four vector lengths, alignment and the builder's scratch space.
constexpr std::size_t kTableBound = 256;

// Hands one given block to the builder, once.
class StaticAllocator final : public flatbuffers::Allocator {
 public:
  explicit StaticAllocator(std::span<std::byte> block) : block_(block) {}
  std::uint8_t* allocate(std::size_t size) override {
    if (size > block_.size()) std::abort();
    return reinterpret_cast<std::uint8_t*>(block_.data());
  }
  void deallocate(std::uint8_t*, std::size_t) override {}
  // Only reached when max_record_len() is wrong; the default one would go to the heap.
  std::uint8_t* reallocate_downward(std::uint8_t*, std::size_t, std::size_t, std::size_t, std::size_t) override {
    std::abort();
  }

 private:
  std::span<std::byte> block_;
};

template <class Wire, class T>
flatbuffers::Offset<flatbuffers::Vector<const Wire*>> add_vector(flatbuffers::FlatBufferBuilder& builder,
                                                                 std::span<const T> items) {
  return builder.CreateVectorOfStructs(reinterpret_cast<const Wire*>(items.data()), items.size());
}

wire::Pose to_wire(const Pose& p) {
  return {p.qw,    p.qx,    p.qy,      p.qz,       p.tx_mm,
          p.ty_mm, p.tz_mm, p.time_ns, p.error_mm, static_cast<std::uint16_t>(p.status)};
}

wire::MaskGrid to_wire(const MaskGrid& g) {
  return {g.x_px, g.y_px, g.step_px, g.width, g.height};
}

Pose from_wire(const wire::Pose& p) {
  return {p.qw(), p.qx(), p.qy(),      p.qz(),       p.tx(),
          p.ty(), p.tz(), p.time_ns(), p.error_mm(), static_cast<PoseStatus>(p.status())};
}

MaskGrid from_wire(const wire::MaskGrid& g) {
  return {g.x(), g.y(), g.step(), g.width(), g.height()};
}

// Builds the FlatBuffer at the end of `space` and moves it to the front. Returns its length.
std::size_t build_payload(const Slice& slice, std::span<std::byte> space) {
  StaticAllocator allocator(space);
  flatbuffers::FlatBufferBuilder builder(space.size() / kPayloadAlign * kPayloadAlign, &allocator);
  const auto points = add_vector<wire::Point>(builder, slice.points);
  const auto contours = add_vector<wire::Contour>(builder, slice.contours);
  const auto field_of_view = add_vector<wire::Point>(builder, slice.field_of_view);
  flatbuffers::Offset<flatbuffers::Vector<const wire::MaskRun*>> runs;
  if (slice.has_mask()) runs = add_vector<wire::MaskRun>(builder, slice.mask_runs);
  const wire::Pose pose = to_wire(slice.pose);
  const wire::MaskGrid grid = to_wire(slice.mask_grid);
  builder.Finish(wire::CreateSlice(builder, &pose, slice.calibration_id, points, contours, field_of_view,
                                   slice.has_mask() ? &grid : nullptr, runs));
  std::memmove(space.data(), builder.GetBufferPointer(), builder.GetSize());
  return builder.GetSize();
}

std::size_t padded_total(std::size_t payload_len) {
  std::size_t total = kHeaderLen + (payload_len + kPayloadAlign - 1) / kPayloadAlign * kPayloadAlign + kTrailerLen;
  if (total % kPacketDivisor == 0) total += kPayloadAlign;
  return total;
}

template <class T>
std::span<const T> view(const auto* vector) {
  if (vector == nullptr || vector->size() == 0) return {};
  return {reinterpret_cast<const T*>(vector->Data()), vector->size()};
}

bool all_finite(std::span<const Point> points) {
  return std::all_of(points.begin(), points.end(),
                     [](const Point& p) { return std::isfinite(p.x_px) && std::isfinite(p.y_px); });
}

SliceFault check_pose(const Pose& p) {
  for (const double number : {p.qw, p.qx, p.qy, p.qz, p.tx_mm, p.ty_mm, p.tz_mm, static_cast<double>(p.error_mm)}) {
    if (!std::isfinite(number)) return SliceFault::non_finite;
  }
  const double norm = std::sqrt(p.qw * p.qw + p.qx * p.qx + p.qy * p.qy + p.qz * p.qz);
  if (!(std::abs(norm - 1) <= 1e-3)) return SliceFault::quaternion;
  return p.status <= PoseStatus::invalid ? SliceFault::none : SliceFault::pose_status;
}

SliceFault check_contours(const Slice& slice, WireLabel max_label) {
  std::uint64_t next = 0;
  for (const Contour& c : slice.contours) {
    if (c.count < 3) return SliceFault::short_contour;
    if (c.first != next) return SliceFault::not_contiguous;
    next += c.count;
    if (next > slice.points.size()) return SliceFault::not_contiguous;
    const bool hole = (c.flags & kHoleFlag) != 0;
    const bool known = c.label <= max_label || c.label == kUnknownLabel;
    if (!known || (c.label == 0 && !hole) || (c.flags & ~kHoleFlag) != 0) return SliceFault::bad_label;
  }
  return next == slice.points.size() ? SliceFault::none : SliceFault::not_contiguous;
}

SliceFault check_mask(const Slice& slice, const SliceLimits& limits) {
  const MaskGrid& grid = slice.mask_grid;
  const std::uint32_t pixels = std::uint32_t{grid.width} * grid.height;
  if (slice.mask_runs.size() > limits.max_mask_runs || pixels > limits.max_mask_pixels) return SliceFault::too_many;
  if (!std::isfinite(grid.x_px) || !std::isfinite(grid.y_px) || !std::isfinite(grid.step_px)) {
    return SliceFault::non_finite;
  }
  std::uint64_t filled = 0;
  for (const MaskRun& run : slice.mask_runs) {
    if (run.count == 0) return SliceFault::mask;
    if (run.label > limits.max_label && run.label != kUnknownLabel) return SliceFault::bad_label;
    filled += run.count;
  }
  return slice.points.empty() && grid.step_px > 0 && filled == pixels ? SliceFault::none : SliceFault::mask;
}

// Numbers that take part in sums of 64 bits.
std::uint64_t record_len(std::uint64_t points, std::uint64_t contours, std::uint64_t runs) {
  return kHeaderLen + kTableBound + sizeof(Point) * points + sizeof(Contour) * contours + sizeof(MaskRun) * runs +
         kMaxPadding + kTrailerLen;
}

}  // namespace

SliceFault check_slice(const Slice& slice, const SliceLimits& limits) {
  if (slice.points.size() > limits.max_points || slice.field_of_view.size() > limits.max_points ||
      slice.contours.size() > limits.max_contours) {
    return SliceFault::too_many;
  }
  if (!all_finite(slice.points) || !all_finite(slice.field_of_view)) return SliceFault::non_finite;
  if (const SliceFault fault = check_pose(slice.pose); fault != SliceFault::none) return fault;
  if (const SliceFault fault = check_contours(slice, limits.max_label); fault != SliceFault::none) return fault;
  const std::size_t corners = slice.field_of_view.size();
  if (corners == 1 || corners == 2) return SliceFault::field_of_view;
  return slice.has_mask() ? check_mask(slice, limits) : SliceFault::none;
}

std::uint64_t max_record_len(const Slice& slice) {
  return record_len(slice.points.size() + slice.field_of_view.size(), slice.contours.size(), slice.mask_runs.size());
}

std::uint64_t max_record_len(const SliceLimits& limits) {
  // A field of view beside either contours or a mask.
  const std::uint64_t contours = record_len(2ull * limits.max_points, limits.max_contours, 0);
  return std::max(contours, record_len(limits.max_points, 0, limits.max_mask_runs));
}

std::size_t encode_slice(const Slice& slice, const RecordInfo& info, std::span<std::byte> record) {
  assert(reinterpret_cast<std::uintptr_t>(record.data()) % kRecordAlign == 0);
  if (max_record_len(slice) > record.size()) return 0;
  const std::size_t payload_len =
      build_payload(slice, record.subspan(kHeaderLen, record.size() - kHeaderLen - kMaxPadding - kTrailerLen));
  const std::size_t total = padded_total(payload_len);
  const std::size_t end = total - kTrailerLen;
  std::memset(record.data() + kHeaderLen + payload_len, 0, end - kHeaderLen - payload_len);

  RecordHeader header{};
  header.magic = kMagic;
  header.header_len = kHeaderLen;
  header.major = kVersion.major;
  header.minor = info.minor;
  header.type = static_cast<std::uint16_t>(RecordType::slice);
  header.incompat = slice.has_mask() ? kIncompatMask : std::uint8_t{0};
  header.total_len = static_cast<std::uint32_t>(total);
  header.payload_len = static_cast<std::uint32_t>(payload_len);
  header.seq = info.seq;
  header.t_device_ns = slice.time_ns;
  header.session_id = info.session_id;
  header.schema_hash = kSchemaHash;
  std::memcpy(record.data(), &header, kHeaderLen);

  const RecordTrailer trailer{crc32c(record.subspan(kHeaderLen, end - kHeaderLen)),
                              static_cast<std::uint32_t>(info.seq), 0, kEndMagic};
  std::memcpy(record.data() + end, &trailer, kTrailerLen);
  return total;
}

void seal_record(std::span<std::byte> record, std::uint32_t device_dropped_total, std::uint16_t ring_used,
                 std::uint16_t ring_capacity) {
  RecordHeader header;
  std::memcpy(&header, record.data(), kHeaderLen);
  header.device_dropped_total = device_dropped_total;
  header.ring_used = ring_used;
  header.ring_capacity = ring_capacity;
  std::memcpy(record.data(), &header, kHeaderLen);
  header.header_crc32c = crc32c(record.first(offsetof(RecordHeader, header_crc32c)));
  std::memcpy(record.data(), &header, kHeaderLen);
}

bool decode_slice(std::span<const std::byte> payload, Slice& slice) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(payload.data());
  flatbuffers::Verifier verifier(bytes, payload.size(), 4, 16);
  if (!wire::VerifySliceBuffer(verifier)) return false;
  const wire::Slice* table = wire::GetSlice(bytes);
  slice.time_ns = 0;
  slice.pose = from_wire(*table->pose());
  slice.calibration_id = table->calibration_id();
  slice.points = view<Point>(table->points());
  slice.contours = view<Contour>(table->contours());
  slice.field_of_view = view<Point>(table->field_of_view());
  slice.mask_runs = view<MaskRun>(table->mask_runs());
  slice.mask_grid = table->mask_grid() == nullptr ? MaskGrid{} : from_wire(*table->mask_grid());
  return true;
}

}  // namespace sonoloft::protocol
