#include "host/scan/mesh_maker.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace sonoloft {
namespace {

using device::PoseStatus;

const char* reason(PoseStatus status) {
  switch (status) {
    case PoseStatus::ok:
      return "";
    case PoseStatus::missing:
      return "no pose: the tracker does not know this probe: check the tool's definition";
    case PoseStatus::out_of_view:
      return "no pose: the probe's markers are hidden: clear the tracker's view";
    case PoseStatus::out_of_volume:
      return "no pose: the probe is outside of the tracker's volume: move the tracker";
    case PoseStatus::high_error:
      return "no pose: the tracker's error is over its limit: check the markers";
    case PoseStatus::invalid:
      return "no pose: the tracker calls its value invalid: check the tracker";
  }
  return "no pose: the tracker's status is unknown: update this program";
}

SliceFate fate(const InsertReport& report) {
  switch (report.outcome) {
    case SliceOutcome::inserted:
      return SliceFate::inserted;
    case SliceOutcome::explained:
      return SliceFate::explained;
    case SliceOutcome::merged:
      return SliceFate::merged;
  }
  return SliceFate::refused;
}

/// The chunks of either mesh, ascending.
std::vector<BrickCoord> all_chunks(const MeshSnapshot& a, const MeshSnapshot& b) {
  std::vector<BrickCoord> all;
  for (const MeshSnapshot* mesh : {&a, &b})
    for (const auto& chunk : mesh->chunks) all.push_back(chunk->coord);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace

Result<MeshMaker> MeshMaker::create(const ReconstructorOptions& options) {
  auto reconstructor = Reconstructor::create(options);
  if (!reconstructor) return tl::unexpected<Error>(reconstructor.error());
  return MeshMaker(std::move(*reconstructor), options.box.center());
}

void MeshMaker::add(std::shared_ptr<const device::DeliveredSlice> slice) {
  SliceReport& report = added_.emplace_back(SliceReport{std::move(slice), SliceFate::refused, {}, 0, 0});
  if (report.slice->pose_status != PoseStatus::ok) {
    report.reason = reason(report.slice->pose_status);
    return;
  }
  const auto start = Clock::now();
  const auto added = reconstructor_.add(report.slice->slice);
  adding_ += Clock::now() - start;
  if (added) {
    report.fate = fate(*added);
    report.insert_ms = added->cells_ms;
  } else {
    report.reason = added.error().message;
  }
}

Result<std::shared_ptr<MeshUpdate>> MeshMaker::make(Detail detail, Slopes slopes) {
  const auto start = Clock::now() - std::exchange(adding_, {});
  auto made = std::make_shared<MeshUpdate>();
  made->slices = std::exchange(added_, {});
  auto updated = reconstructor_.update(detail, slopes);
  if (!updated) return tl::unexpected<Error>(updated.error());
  sampling_ms_ = updated->sampling_ms();
  revision_ += made->slices.size();
  skipped_revisions_ += made->slices.empty() ? 0 : made->slices.size() - 1;
  made->revision = revision_;
  made->skipped_revisions = skipped_revisions_;
  made->detail = detail;
  made->settled = updated->unsettled_cells == 0;
  made->mesh = reconstructor_.mesh();
  made->reconstruct_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  made->labels = statistics_[static_cast<std::size_t>(detail)].update(made->mesh, updated->changed_chunks);
  made->changed_chunks = std::move(updated->changed_chunks);
  if (detail != shown_.detail) made->changed_chunks = all_chunks(shown_.mesh, made->mesh);
  shown_ = {detail, made->mesh};
  made->size = reconstructor_.counts();
  return made;
}

}  // namespace sonoloft
