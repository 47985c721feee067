#include "host/view/scene/scene.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>
#include <vector>

#include "host/view/scene/little_endian.h"

namespace sonoloft::view {
namespace {

using Json = nlohmann::json;

/// Points of a slice that are drawn; of more, every n-th.
constexpr std::size_t kMaxSlicePoints = 20000;
constexpr std::size_t kArrivalsForRate = 32;
constexpr std::size_t kBricksRenewed = 32;
/// The scan waits while it says what was seen: a twentieth of its time at most.
constexpr int kCoveragePauses = 20;

Json labels_json(const MeshUpdate& mesh, const LabelTable& table) {
  Json labels = Json::array();
  for (const LabelStatistics& s : mesh.labels)
    labels.push_back({{"label", s.label},
                      {"name", table.name(s.label)},
                      {"colour", table.colour(s.label)},
                      {"volume_ml", s.volume_ml}});
  return labels;
}

Json counts_json(const SliceCounts& c) {
  return {{"delivered", c.delivered}, {"inserted", c.inserted}, {"explained", c.explained},
          {"merged", c.merged},       {"refused", c.refused},   {"dropped", c.dropped}};
}

Json ledger_json(const device::Ledger& l) {
  return {{"made", l.made},
          {"delivered", l.delivered},
          {"host_dropped", l.host_dropped},
          {"crc_bad", l.crc_bad},
          {"malformed", l.malformed},
          {"transport_lost", l.transport_lost},
          {"device_dropped", l.device_dropped}};
}

Json recording_json(const ViewRecording& r) {
  return {{"file", r.file},       {"running", r.running},           {"seconds", r.seconds},
          {"records", r.records}, {"not_recorded", r.not_recorded}, {"failure", r.failure}};
}

Json vector_json(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json coverage_json(const Coverage& c) {
  Json json = {{"volume_ml", 1e-3 * c.volume_mm3}, {"seen", c.seen_fraction()}, {"near_mm", c.near_mm}};
  if (!c.largest_gap) return json;
  const Eigen::Isometry3d& plane = c.largest_gap->suggested_image_to_reference;
  json["gap"] = {{"volume_ml", 1e-3 * c.largest_gap->volume_mm3},
                 {"centre", vector_json(plane.translation())},
                 {"normal", vector_json(plane.linear().col(2))}};
  return json;
}

/// The loops of a slice in the reference frame; `first` and `count` are in points that were appended.
class LoopWriter {
 public:
  LoopWriter(const TrackedSlice& slice, std::string& out)
      : slice_(slice), out_(out), stride_(1 + (slice.points.size() + slice.field_of_view.size()) / kMaxSlicePoints) {}

  Json append_loop(std::span<const Eigen::Vector2d> loop) {
    const std::size_t first = points_;
    for (std::size_t i = 0; i < loop.size(); i += stride_, ++points_) {
      const Eigen::Vector3f p =
          (slice_.image_to_reference * Eigen::Vector3d(loop[i].x(), loop[i].y(), 0)).cast<float>();
      append(out_, std::span<const float>(p.data(), 3));
    }
    return {{"first", first}, {"count", points_ - first}};
  }
  [[nodiscard]] std::size_t points() const { return points_; }

 private:
  const TrackedSlice& slice_;
  std::string& out_;
  std::size_t stride_, points_ = 0;
};

const char* name(Detail detail) {
  return detail == Detail::full ? "full" : detail == Detail::coarse ? "coarse" : "draft";
}

}  // namespace

void Scene::take(const News& news) {
  ++stamp_;
  if (news.state) state_ = *news.state;
  if (news.recording) recording_ = news.recording;
  if (news.slice) {
    slice_ = news.slice;
    slices_ = stamp_;
  }
  path_.add(news.path);
  if (!news.mesh) return;
  mesh_ = news.mesh;
  bricks_.take(mesh_->mesh);
  for (const SliceReport& report : mesh_->slices) {
    latency_ms_ = report.latency_ms;
    arrivals_.push_back(report.slice->arrival);
    if (arrivals_.size() > kArrivalsForRate) arrivals_.pop_front();
  }
}

Json Scene::status() const {
  Json status = {{"state", state_.words},
                 {"stop", state_.running && source_.stop},
                 {"record", state_.running && source_.record},
                 {"measured", static_cast<bool>(source_.confidence)},
                 {"cover", static_cast<bool>(source_.coverage)}};
  if (recording_) status["recording"] = recording_json(*recording_);
  if (source_.ledger) status["ledger"] = ledger_json(source_.ledger());
  if (!mesh_) return status;
  status["labels"] = labels_json(*mesh_, source_.labels);
  if (mesh_->revision == 0) return status;  // of a file
  std::chrono::duration<double> span{0};
  if (!arrivals_.empty()) span = arrivals_.back() - arrivals_.front();
  status["slices"] = counts_json(mesh_->counts);
  status["latency_ms"] = latency_ms_;
  status["reconstruct_ms"] = mesh_->reconstruct_ms;
  status["rate_hz"] = span.count() > 0 ? static_cast<double>(arrivals_.size() - 1) / span.count() : 0;
  status["detail"] = name(mesh_->detail);
  return status;
}

Json Scene::append_slice(Cursor& cursor, std::string& out) const {
  if (!slice_ || cursor.slice == slices_) return nullptr;
  cursor.slice = slices_;
  const TrackedSlice& slice = slice_->slice;
  LoopWriter writer(slice, out);
  Json contours = Json::array();
  for (const Contour& contour : slice.contours) {
    Json loop = writer.append_loop(std::span(slice.points).subspan(contour.first, contour.count));
    loop["label"] = contour.label;
    loop["colour"] = source_.labels.colour(contour.label);
    contours.push_back(std::move(loop));
  }
  const Json view = writer.append_loop(slice.field_of_view);
  return {{"id", slice.id}, {"contours", std::move(contours)}, {"view", view}, {"points", writer.points()}};
}

void Scene::renew_coverage() {
  const auto begin = std::chrono::steady_clock::now();
  if (covered_ == mesh_ || begin < coverage_due_) return;
  coverage_ = source_.coverage();
  covered_ = mesh_;
  const auto end = std::chrono::steady_clock::now();
  coverage_due_ = end + kCoveragePauses * (end - begin);
}

std::string Scene::message(Cursor& cursor) {
  if (cursor.measured) bricks_.renew_confidence(kBricksRenewed);
  std::string body;
  const std::uint64_t epoch = cursor.path.epoch;
  const std::span<const Eigen::Vector3f> path = path_.newer(cursor.path);
  for (const Eigen::Vector3f& p : path) append(body, std::span<const float>(p.data(), 3));
  Json head = status();
  head["path"] = {{"again", cursor.path.epoch != epoch}, {"points", path.size()}};
  head["slice"] = append_slice(cursor, body);
  if (std::exchange(cursor.coverage, false)) {
    renew_coverage();
    if (covered_) head["coverage"] = coverage_json(coverage_);
  }
  const std::size_t bricks = bricks_.append_newer(cursor.bricks, cursor.measured, kSoftLimit, body);
  cursor.bricks_sent += bricks;
  cursor.stamp = stamp_;
  head["bricks"] = {{"here", bricks},
                    {"sent", cursor.bricks_sent},
                    {"all", bricks_.count()},
                    {"triangles", bricks_.triangles()},
                    {"faces", bricks_.faces()},
                    {"more", cursor.bricks != bricks_.version()}};
  std::string text = head.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string message;
  message.reserve(4 + text.size() + body.size());
  append(message, static_cast<std::uint32_t>(text.size()));
  return message += text += body;
}

}  // namespace sonoloft::view
