#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/capi/capi_mesh.h"
#include "host/capi/capi_probe.h"
#include "host/capi/capi_status.h"
#include "host/scan/scan_session.h"

using namespace sonoloft;
using namespace sonoloft::capi;

struct sonoloft_scan {
  std::unique_ptr<ScanSession> session;
  sonoloft_device_info device;
};

namespace {

static_assert(SONOLOFT_DISCONNECTED == static_cast<int>(ScanEventKind::disconnected));
static_assert(SONOLOFT_DEVICE_FAULT == static_cast<int>(ScanEventKind::device_fault));
static_assert(SONOLOFT_SLICES_DROPPED == static_cast<int>(ScanEventKind::slices_dropped));
static_assert(SONOLOFT_CALLBACK_THREW == static_cast<int>(ScanEventKind::callback_threw));
static_assert(SONOLOFT_RECONSTRUCTION_FAILED == static_cast<int>(ScanEventKind::reconstruction_failed));
static_assert(SONOLOFT_END_OF_DATA == static_cast<int>(ScanEventKind::end_of_data));
static_assert(SONOLOFT_BUTTON == static_cast<int>(ScanEventKind::button));
static_assert(SONOLOFT_CAPS_GAP == static_cast<int>(Caps::gap));
static_assert(SONOLOFT_CAPS_SLICE == static_cast<int>(Caps::slice));
static_assert(SONOLOFT_CAPS_BOX == static_cast<int>(Caps::box));
static_assert(SONOLOFT_BLOB_FIRMWARE == static_cast<int>(device::BlobKind::firmware));
static_assert(SONOLOFT_BLOB_CALIBRATION == static_cast<int>(device::BlobKind::calibration));

Result<ScanOptions> options_of(const sonoloft_scan_options* given) {
  const auto read = read_sized(given);
  if (!read) return tl::unexpected<Error>(read.error());
  ScanOptions options;
  ReconstructorOptions& r = options.reconstructor;
  r.box = {Eigen::Vector3d(read->box_min_mm), Eigen::Vector3d(read->box_max_mm)};
  r.spacing_mm = read->spacing_mm;
  if (read->background_mm != 0) r.background_mm = read->background_mm;
  if (read->threads != 0) r.threads = read->threads;
  if (read->processor_only != 0) r.device = DeviceChoice::cpu;
  if (read->interpolate_all != 0) r.admission = Admission::everything;
  if (read->step_field != 0) r.field = FieldMethod::step;
  if (read->caps < SONOLOFT_CAPS_GAP || read->caps > SONOLOFT_CAPS_BOX)
    return fail(ErrorCode::invalid_argument, "caps is " + std::to_string(read->caps) +
                                                 ": give one of sonoloft_caps, or zero the options before use");
  r.caps = static_cast<Caps>(read->caps);
  if (read->lossless != 0) options.stream.mode = device::StreamMode::lossless;
  if (read->queue_slices != 0) options.queue_capacity = read->queue_slices;
  if (read->interpolate_poses != 0) options.pose_offset = std::chrono::nanoseconds(read->pose_offset_ns);
  return options;
}

ScanCallbacks callbacks_of(const sonoloft_callbacks& c) {
  ScanCallbacks callbacks;
  if (c.on_mesh) {
    callbacks.on_mesh = [c](std::shared_ptr<const MeshUpdate> update) {
      const std::unique_ptr<sonoloft_mesh, decltype(&sonoloft_mesh_release)> mesh(new sonoloft_mesh(std::move(update)),
                                                                                  &sonoloft_mesh_release);
      c.on_mesh(c.user, mesh.get());
    };
  }
  if (c.on_event) {
    callbacks.on_event = [c](const ScanEvent& event) {
      const device::Button button = event.button.value_or(device::Button{});
      const sonoloft_event of_c{
          static_cast<sonoloft_event_kind>(event.kind),         event.message.c_str(), button.number,
          button.pressed ? std::uint16_t{1} : std::uint16_t{0}, button.time.count(),   ends_run(event.kind) ? 1 : 0};
      c.on_event(c.user, &of_c);
    };
  }
  if (c.on_slice) {
    callbacks.on_slice = [c](std::shared_ptr<const device::DeliveredSlice> slice) {
      const auto contours = contours_of(slice->slice);
      const sonoloft_slice of_c = slice_of(*slice, contours);
      c.on_slice(c.user, &of_c);
    };
  }
  return callbacks;
}

sonoloft_statistics statistics_of(const ScanSession& session) {
  const SliceCounts counts = session.counts();
  const device::Ledger ledger = session.ledger();
  sonoloft_statistics s{};
  s.delivered = counts.delivered;
  s.inserted = counts.inserted;
  s.explained = counts.explained;
  s.merged = counts.merged;
  s.refused = counts.refused;
  s.dropped = counts.dropped;
  s.made = ledger.made;
  s.sent_on = ledger.delivered;
  s.host_dropped = ledger.host_dropped;
  s.crc_bad = ledger.crc_bad;
  s.malformed = ledger.malformed;
  s.lost = ledger.transport_lost;
  s.device_dropped = ledger.device_dropped;
  s.closed = ledger.closed;
  return s;
}

sonoloft_coverage coverage_of(const Coverage& coverage) {
  constexpr double kMlPerMm3 = 1e-3;
  sonoloft_coverage c{};
  c.volume_ml = kMlPerMm3 * coverage.volume_mm3;
  c.seen_ml = kMlPerMm3 * coverage.seen_mm3;
  c.near_mm = coverage.near_mm;
  if (const auto& gap = coverage.largest_gap) {
    c.gap_ml = kMlPerMm3 * gap->volume_mm3;
    Eigen::Map<Eigen::Vector3d>(c.gap_centre_mm) = gap->centre_mm;
    write_rows(gap->suggested_image_to_reference, c.gap_image_to_reference);
  }
  return c;
}

}  // namespace

sonoloft_status sonoloft_scan_open(sonoloft_probe* probe, const sonoloft_scan_options* options, sonoloft_scan** scan,
                                   sonoloft_error* error) {
  const std::unique_ptr<sonoloft_probe> taken(probe);
  return guarded(error, [&]() -> Result<void> {
    if (auto given = need(probe, scan); !given) return given;
    const auto wanted = options_of(options);
    if (!wanted) return tl::unexpected<Error>(wanted.error());
    auto session = ScanSession::open(std::move(taken->transport), *wanted);
    if (!session) return tl::unexpected<Error>(session.error());
    const device::DeviceInfo& device = (*session)->device_info();
    const sonoloft_device_info info{device.serial.c_str(), device.firmware_version.c_str(),
                                    (*session)->field_device().c_str()};
    *scan = new sonoloft_scan{std::move(*session), info};
    return {};
  });
}

sonoloft_status sonoloft_scan_start(sonoloft_scan* scan, const sonoloft_callbacks* callbacks, sonoloft_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (auto given = need(scan); !given) return given;
    const auto read = read_sized(callbacks);
    if (!read) return tl::unexpected<Error>(read.error());
    return scan->session->start(callbacks_of(*read));
  });
}

void sonoloft_scan_stop(sonoloft_scan* scan) {
  if (scan) scan->session->stop();
}

void sonoloft_scan_close(sonoloft_scan* scan) {
  delete scan;
}

sonoloft_status sonoloft_scan_send_blob(sonoloft_scan* scan, sonoloft_blob_kind kind, const void* bytes, size_t length,
                                        sonoloft_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (auto given = need(scan, bytes); !given) return given;
    return scan->session->send_blob(static_cast<device::BlobKind>(kind),
                                    {static_cast<const std::byte*>(bytes), length});
  });
}

sonoloft_status sonoloft_scan_withdraw(sonoloft_scan* scan, uint64_t slice_id, sonoloft_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (auto given = need(scan); !given) return given;
    return scan->session->withdraw(slice_id);
  });
}

const sonoloft_device_info* sonoloft_scan_device(const sonoloft_scan* scan) {
  return scan ? &scan->device : nullptr;
}

sonoloft_status sonoloft_scan_statistics(const sonoloft_scan* scan, sonoloft_statistics* statistics,
                                         sonoloft_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (auto given = need(scan); !given) return given;
    return write_sized(statistics_of(*scan->session), statistics);
  });
}

sonoloft_status sonoloft_scan_coverage(const sonoloft_scan* scan, sonoloft_coverage* coverage, sonoloft_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (auto given = need(scan); !given) return given;
    return write_sized(coverage_of(scan->session->coverage()), coverage);
  });
}

sonoloft_status sonoloft_scan_confidence(const sonoloft_scan* scan, const float* positions_mm, size_t count,
                                         float* measured, float* distance_mm, sonoloft_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (auto given = need(scan, positions_mm, measured, distance_mm); !given) return given;
    std::vector<Eigen::Vector3f> points(count);
    for (std::size_t i = 0; i < count; ++i) points[i] = Eigen::Vector3f(positions_mm + 3 * i);
    const Confidence sure = scan->session->confidence(points);
    std::copy(sure.measured.begin(), sure.measured.end(), measured);
    std::copy(sure.distance_mm.begin(), sure.distance_mm.end(), distance_mm);
    return {};
  });
}
