#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/io/byte_file.h"
#include "core/io/slices/slice_file_builder.h"
#include "core/io/text_scanner.h"
#include "core/slice/section.h"

namespace sonoloft {
namespace {

using Eigen::Vector2d;

struct FileEdge {
  std::uint32_t from, to;
  Label left, right;
};

double cross(const Vector2d& p, const Vector2d& q) {
  return p.x() * q.y() - p.y() * q.x();
}

/// Exchanges the sides of all edges where they say that the labelled part of the plane has a negative area.
bool flip_sides(std::vector<FileEdge>& edges, const std::vector<Vector2d>& points) {
  double area = 0;
  for (const FileEdge& e : edges)
    area += ((e.left != kOutside) - (e.right != kOutside)) * cross(points[e.from], points[e.to]);
  if (area >= 0) return false;
  for (FileEdge& e : edges) std::swap(e.left, e.right);
  return true;
}

/// Traces the border of every label's regions, each with the label on its left.
class LoopTracer {
 public:
  LoopTracer(const std::vector<FileEdge>& edges, const std::vector<Vector2d>& points) : points_(points) {
    for (const FileEdge& e : edges) {
      if (e.left == e.right || e.from == e.to) continue;
      if (e.left != kOutside) half_edges_.push_back({e.left, e.from, e.to, false});
      if (e.right != kOutside) half_edges_.push_back({e.right, e.to, e.from, false});
    }
    std::sort(half_edges_.begin(), half_edges_.end(), [](const HalfEdge& g, const HalfEdge& h) {
      return std::tuple(g.label, g.from, g.to) < std::tuple(h.label, h.from, h.to);
    });
  }

  /// @error bad_contour where a border does not close
  Result<std::vector<FileLoop>> trace() {
    std::vector<FileLoop> loops;
    for (std::size_t i = kMaxDegree; i < half_edges_.size(); ++i)
      if (key(half_edges_[i]) == key(half_edges_[i - kMaxDegree]))
        return fail(ErrorCode::bad_contour, "over 64 borders of one label meet in a vertex: mend the edges");
    for (HalfEdge& start : half_edges_) {
      if (start.used) continue;
      FileLoop loop{{start.from}, start.label, false};
      for (HalfEdge* h = next_of(start); h != &start; h = next_of(*h)) {
        if (h == nullptr)
          return fail(ErrorCode::bad_contour, "the labels around a vertex contradict each other: mend the edges");
        h->used = true;
        loop.vertices.push_back(h->from);
      }
      start.used = true;
      loop.hole = area(loop) < 0;
      loops.push_back(std::move(loop));
    }
    return loops;
  }

 private:
  struct HalfEdge {
    Label label;
    std::uint32_t from, to;
    bool used;
  };
  static constexpr std::size_t kMaxDegree = 64;  // each step looks at all of them

  static std::pair<Label, std::uint32_t> key(const HalfEdge& h) { return {h.label, h.from}; }

  /// The border goes on with the first edge of the label clockwise from the one that it came in on: between the two
  /// lies the same region. Regions that touch in a vertex so become loops of their own.
  HalfEdge* next_of(const HalfEdge& in) {
    const std::pair wanted(in.label, in.to);
    const Vector2d back = points_[in.from] - points_[in.to];
    HalfEdge* best = nullptr;
    double smallest_turn = 0;
    auto h = std::lower_bound(half_edges_.begin(), half_edges_.end(), wanted,
                              [](const HalfEdge& g, const auto& k) { return key(g) < k; });
    for (; h != half_edges_.end() && key(*h) == wanted; ++h) {
      if (h->used) continue;
      const Vector2d out = points_[h->to] - points_[h->from];
      double turn = std::atan2(cross(out, back), out.dot(back));
      if (turn <= 0) turn += 2 * std::numbers::pi;
      if (best != nullptr && turn >= smallest_turn) continue;
      best = &*h;
      smallest_turn = turn;
    }
    return best;
  }

  double area(const FileLoop& loop) const {
    double sum = 0;
    for (std::size_t i = 0; i < loop.vertices.size(); ++i)
      sum += cross(points_[loop.vertices[i]], points_[loop.vertices[(i + 1) % loop.vertices.size()]]);
    return sum;
  }

  const std::vector<Vector2d>& points_;
  std::vector<HalfEdge> half_edges_;  ///< ascending by label, from, to
};

void read_plane(TextScanner& in, FilePlane& plane, std::vector<FileEdge>& edges) {
  plane.normal = in.vector("a plane's normal");
  plane.line = in.line();
  plane.offset = in.real("a plane's constant");
  const std::size_t vertex_count = in.count("a number of vertices", kMaxSlicePoints, 6);
  const std::size_t edge_count = in.count("a number of edges", kMaxSlicePoints, 8);
  for (std::size_t k = 0; k < vertex_count && !in.failed(); ++k) plane.vertices.push_back(in.vector("a coordinate"));
  if (edge_count > 0 && vertex_count == 0)
    in.set_error(ErrorCode::parse_failed, "edges in a plane without vertices: mend the line");
  for (std::size_t k = 0; k < edge_count && !in.failed(); ++k) {
    const auto vertex = [&] {
      return static_cast<std::uint32_t>(in.whole("a vertex number", vertex_count - 1, ErrorCode::parse_failed));
    };
    const auto label = [&] { return static_cast<Label>(in.whole("a label", kMaxLabel, ErrorCode::bad_contour)); };
    FileEdge& e = edges.emplace_back();
    e.from = vertex();
    e.to = vertex();
    e.left = label();
    e.right = label();
  }
}

Result<std::vector<FileLoop>> trace_loops(const FilePlane& plane, std::vector<FileEdge>& edges, const std::string& name,
                                          SliceFileNotes& notes) {
  notes.flipped_sides += flip_sides(edges, plane.image);
  auto loops = LoopTracer(edges, plane.image).trace();
  if (!loops)
    return fail(loops.error().code,
                name + ":" + std::to_string(plane.line) + ": in this plane " + loops.error().message);
  const std::size_t dropped = std::erase_if(*loops, [](const FileLoop& loop) { return loop.vertices.size() < 3; });
  notes.dropped_components += static_cast<std::uint32_t>(dropped);
  return loops;
}

}  // namespace

Result<SliceFile> parse_contour(std::string_view text, std::string_view name) {
  TextScanner in(text, name);
  if (in.at_end()) return fail(ErrorCode::empty_input, std::string(name) + ": the file is empty");
  const std::size_t plane_count = in.count("the number of planes", kMaxFileSlices, 12);
  SliceFileNotes notes;
  std::vector<FilePlane> planes;
  std::vector<std::vector<FileEdge>> edges;
  for (std::size_t i = 0; i < plane_count && !in.failed(); ++i)
    read_plane(in, planes.emplace_back(), edges.emplace_back());
  if (in.failed()) return in.failure();
  notes.trailing_text = !in.at_end();

  if (auto ok = place_planes(planes, std::string(name), notes); !ok) return tl::unexpected(ok.error());
  std::vector<std::vector<FileLoop>> loops;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    auto traced = trace_loops(planes[i], edges[i], std::string(name), notes);
    if (!traced) return tl::unexpected(traced.error());
    loops.push_back(std::move(*traced));
  }
  return build_slices(planes, loops, std::string(name), notes);
}

Result<SliceFile> read_contour(const std::filesystem::path& path) {
  return read_bytes(path).and_then(
      [&](const std::string& text) { return parse_contour(text, path.filename().string()); });
}

}  // namespace sonoloft
