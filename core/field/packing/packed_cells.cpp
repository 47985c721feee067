#include "core/field/packing/packed_cells.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/field/packing/stretches.h"

namespace sonoloft {
namespace {

/// Diameter of the smallest ball around the centre that holds the cell; 0 when the faces have no edges.
double size_mm(std::span<const CellFace> faces, const Eigen::Vector3d& centre_mm) {
  double radius2 = 0;
  for (const CellFace& face : faces) {
    const Eigen::Vector3d centre = face.image_to_reference->inverse() * centre_mm;
    for (const FaceEdge& edge : *face.polygon)
      radius2 = std::max(radius2, (edge.a - centre.head<2>()).squaredNorm() + centre.z() * centre.z());
  }
  return 2 * std::sqrt(radius2);
}

std::uint32_t slot_of(Label label, std::span<const Label> slots, std::uint32_t unknown_slot) {
  if (label == kBeyondFace) return SONOLOFT_NO_SLOT;
  if (label == kUnknown) return unknown_slot;
  return static_cast<std::uint32_t>(std::lower_bound(slots.begin(), slots.end(), label) - slots.begin());
}

bool moves(const VertexBend& bend) {
  return bend.slope != 0 || bend.curvature_per_mm != 0;
}

}  // namespace

void PackedCells::clear() {
  cells_.clear();
  faces_.clear();
  runs_.clear();
  edges_.clear();
  vertices_.clear();
  stretches_.clear();
  labels_.clear();
  centres_mm_.clear();
}

std::uint32_t PackedCells::add(std::span<const CellFace> faces, const Eigen::Vector3d& centre_mm,
                               std::span<const std::uint32_t> apart, std::span<const FaceBends> bends) {
  const auto index = static_cast<std::uint32_t>(cells_.size());
  const auto first_label = static_cast<std::uint32_t>(labels_.size());
  const auto first_face = static_cast<std::uint32_t>(faces_.size());
  collect_labels(faces, apart);
  const std::span<const Label> slots(labels_.data() + first_label, labels_.size() - first_label);
  if (slots.size() > 1) {
    const double unit_mm = size_mm(faces, centre_mm);
    const auto first_unknown =
        static_cast<std::uint32_t>(std::lower_bound(slots.begin(), slots.end(), kUnknown) - slots.begin());
    auto next_apart = static_cast<std::uint32_t>(slots.size() - apart.size());
    for (std::uint32_t i = 0; i < faces.size(); ++i) {
      const bool is_apart = std::binary_search(apart.begin(), apart.end(), i);
      add_face(faces[i], centre_mm, unit_mm, slots, is_apart ? next_apart++ : first_unknown,
               bends.empty() ? FaceBends{} : bends[i]);
    }
  }
  const auto face_count = static_cast<std::uint32_t>(faces_.size()) - first_face;
  cells_.push_back({first_face, face_count, static_cast<std::uint32_t>(slots.size()), first_label});
  centres_mm_.push_back(centre_mm);
  return index;
}

void PackedCells::append(const PackedCells& others) {
  const auto behind = [](auto& all, const auto& more, auto rebase) {
    const auto first = all.insert(all.end(), more.begin(), more.end());
    std::for_each(first, all.end(), rebase);
  };
  const auto as_is = [](const auto&) {};
  const auto size = [](const auto& all) { return static_cast<std::uint32_t>(all.size()); };
  const std::uint32_t first_face = size(faces_), first_run = size(runs_), first_edge = size(edges_),
                      first_vertex = size(vertices_), first_stretch = size(stretches_), first_label = size(labels_);
  behind(cells_, others.cells_,
         [&](kernels::PackedCell& cell) { cell.first_face += first_face, cell.first_label += first_label; });
  behind(runs_, others.runs_, as_is);
  behind(faces_, others.faces_, [&](kernels::PackedFace& face) {
    face.first_run += first_run, face.first_outline += first_edge;
    const std::span runs = std::span(runs_).subspan(face.first_run, face.rigid_count + face.bent_count);
    for (kernels::PackedRun& run : runs.first(face.rigid_count)) run.first += first_edge;
    for (kernels::PackedRun& run : runs.last(face.bent_count))
      run.first += first_vertex, run.first_stretch += first_stretch;
  });
  behind(edges_, others.edges_, as_is);
  behind(vertices_, others.vertices_, as_is);
  behind(stretches_, others.stretches_, [&](kernels::PackedStretch& stretch) { stretch.first += first_vertex; });
  behind(labels_, others.labels_, as_is);
  behind(centres_mm_, others.centres_mm_, as_is);
}

std::uint32_t PackedCells::edge_count(std::uint32_t cell) const {
  std::uint32_t count = 0;
  const kernels::PackedCell& c = cells_[cell];
  for (const kernels::PackedFace& face : faces().subspan(c.first_face, c.face_count)) {
    count += face.outline_count;
    for (const kernels::PackedRun& run : runs().subspan(face.first_run, face.rigid_count + face.bent_count))
      count += run.count;
  }
  return count;
}

/// Appends the slots of a cell to labels_. A cell with nothing but slivers for faces is unknown.
void PackedCells::collect_labels(std::span<const CellFace> faces, std::span<const std::uint32_t> apart) {
  const auto first = static_cast<std::ptrdiff_t>(labels_.size());
  const auto note = [&](Label label) {
    if (label == kBeyondFace) return;
    const auto at = std::lower_bound(labels_.begin() + first, labels_.end(), label);
    if (at == labels_.end() || *at != label) labels_.insert(at, label);
  };
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    const bool is_apart = std::binary_search(apart.begin(), apart.end(), i);
    Label left = kBeyondFace, right = kBeyondFace;  // of the edge before: most have the same
    for (const FaceEdge& edge : *faces[i].polygon) {
      if (edge.left == left && edge.right == right) continue;
      left = edge.left, right = edge.right;
      for (const Label label : {left, right})
        if (label != kUnknown || !is_apart) note(label);
    }
  }
  labels_.insert(labels_.end(), apart.size(), kUnknown);
  if (static_cast<std::ptrdiff_t>(labels_.size()) == first) note(kUnknown);
}

void PackedCells::add_face(const CellFace& face, const Eigen::Vector3d& centre_mm, double unit_mm,
                           std::span<const Label> slots, std::uint32_t unknown_slot, const FaceBends& bends) {
  const Eigen::Vector3d centre = face.image_to_reference->inverse() * centre_mm;
  const Image image = {centre.head<2>(), unit_mm, face.above ? 1.0f : -1.0f};
  const std::span<const EdgeBends> edge_bends = bends.bends.empty() || face.label != kBeyondFace
                                                    ? std::span<const EdgeBends>()
                                                    : bent_face_.bend(*face.polygon, bends);
  collect_edges(*face.polygon, slots, unknown_slot, edge_bends);
  if (slotted_.empty()) return;
  kernels::PackedFace packed{};
  packed.first_run = static_cast<std::uint32_t>(runs_.size());
  std::size_t i = 0;
  for (; i < slotted_.size() && !slotted_[i].bent; ++packed.rigid_count) i = add_rigid_run(*face.polygon, image, i);
  for (; i < slotted_.size(); ++packed.bent_count) i = add_bent_run(*face.polygon, image, edge_bends, i);
  packed.first_outline = static_cast<std::uint32_t>(edges_.size());
  for (const FaceEdge& edge : *face.polygon)
    if (packed.bent_count != 0 && edge.right == kBeyondFace) add_edge(image, edge.a, edge.b);
  packed.outline_count = static_cast<std::uint32_t>(edges_.size()) - packed.first_outline;
  // The in-plane sums are the same seen from either side of the plane; only the height must count from the cell's side.
  const Eigen::Matrix3d& axes = face.image_to_reference->linear();
  const Eigen::Vector3f u = (axes.col(0) / unit_mm).cast<float>();
  const Eigen::Vector3f v = (axes.col(1) / unit_mm).cast<float>();
  const Eigen::Vector3f n = (axes.col(2) * (image.side / unit_mm)).cast<float>();
  packed.ux = u.x(), packed.uy = u.y(), packed.uz = u.z();
  packed.vx = v.x(), packed.vy = v.y(), packed.vz = v.z();
  packed.nx = n.x(), packed.ny = n.y(), packed.nz = n.z();
  packed.height = static_cast<float>(centre.z() * image.side / unit_mm);
  faces_.push_back(packed);
}

void PackedCells::add_edge(const Image& image, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2f start = image(a);
  const Eigen::Vector2f along = ((b - a) / image.unit_mm).cast<float>();
  const float length2 = along.squaredNorm();
  if (length2 > 0) edges_.push_back({start.x(), start.y(), along.x(), along.y(), length2});
}

void PackedCells::add_vertex(const Image& image, const Eigen::Vector2d& point, const VertexBend& bend) {
  const Eigen::Vector2f at = image(point);
  const double fading2 = std::pow(bend.fading_per_mm * image.unit_mm, 2);
  vertices_.push_back({at.x(), at.y(), bend.outward.x(), bend.outward.y(), image.side * bend.slope,
                       static_cast<float>(bend.curvature_per_mm * image.unit_mm),
                       static_cast<float>(fading2 * fading2)});
}

/// Fills slotted_: the rigid edges first, then by slots; of these in the order in which they follow each other along
/// their contours.
void PackedCells::collect_edges(const FacePolygon& polygon, std::span<const Label> slots, std::uint32_t unknown_slot,
                                std::span<const EdgeBends> bends) {
  cut_into_pieces(polygon, slots, unknown_slot, bends);
  const auto kind = [](const Piece& p) { return std::tuple(p.bent, p.left, p.right); };
  std::sort(pieces_.begin(), pieces_.end(), [&](const Piece& a, const Piece& b) {
    return std::tuple(kind(a), a.first_edge) < std::tuple(kind(b), b.first_edge);
  });
  slotted_.clear();
  for (auto first = pieces_.begin(); first != pieces_.end();) {
    const auto last = std::find_if(first, pieces_.end(), [&](const Piece& p) { return kind(p) != kind(*first); });
    if (first->bent) {
      link({first, last});
    } else {
      for (const Piece& piece : std::span(first, last)) take(piece);
    }
    first = last;
  }
}

/// Fills pieces_, in the order of the polygon.
void PackedCells::cut_into_pieces(const FacePolygon& polygon, std::span<const Label> slots, std::uint32_t unknown_slot,
                                  std::span<const EdgeBends> bends) {
  pieces_.clear();
  const FaceEdge* before = nullptr;
  std::uint32_t left = 0, right = 0;
  for (std::uint32_t i = 0; i < polygon.size(); ++i) {
    const FaceEdge& edge = polygon[i];
    if (edge.a == edge.b) continue;
    if (before == nullptr || edge.left != before->left || edge.right != before->right) {
      left = slot_of(edge.left, slots, unknown_slot);
      right = slot_of(edge.right, slots, unknown_slot);
    }
    const bool bent = !bends.empty() && (moves(bends[i].a) || moves(bends[i].b));
    const bool goes_on = before == &edge - 1 && before->left == edge.left && before->right == edge.right &&
                         pieces_.back().bent == bent && (!bent || before->b == edge.a);
    // The sum over an edge changes sign with its direction, so every pair of labels needs one kind of run only.
    if (!goes_on)
      pieces_.push_back({bent, left > right, std::min(left, right), std::max(left, right), i, i, edge.a, edge.a});
    Piece& piece = pieces_.back();
    (piece.turned ? piece.start : piece.end) = edge.b;
    piece.behind_last = i + 1;
    before = &edge;
  }
}

/// Appends the edges of a piece to slotted_.
void PackedCells::take(const Piece& piece) {
  const std::uint32_t count = piece.behind_last - piece.first_edge;
  for (std::uint32_t k = 0; k < count; ++k)
    slotted_.push_back({piece.turned ? piece.behind_last - 1 - k : piece.first_edge + k, piece.bent, piece.turned,
                        piece.left, piece.right});
}

/// Takes each piece behind the one that ends where it starts, where there is one.
void PackedCells::link(std::span<Piece> pieces) {
  const auto before = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q) {
    return std::tuple(p.x(), p.y()) < std::tuple(q.x(), q.y());
  };
  std::ranges::sort(pieces, before, &Piece::start);
  const auto follower = [&](const Eigen::Vector2d& end, auto free) -> Piece* {
    auto at = std::ranges::lower_bound(pieces, end, before, &Piece::start);
    while (at != pieces.end() && at->start == end && !free(*at)) ++at;
    return at != pieces.end() && at->start == end ? &*at : nullptr;
  };
  for (const Piece& piece : pieces)
    if (Piece* next = follower(piece.end, [](const Piece& p) { return !p.follows; })) next->follows = true;
  for (const bool loops : {false, true})
    for (Piece& head : pieces)
      if (loops || !head.follows)
        for (Piece* at = head.taken ? nullptr : &head; at != nullptr;
             at = follower(at->end, [](const Piece& p) { return !p.taken; })) {
          at->taken = true;
          take(*at);
        }
}

/// All edges from slotted_[first] on with the same slots. @return the first one after them
std::size_t PackedCells::add_rigid_run(const FacePolygon& polygon, const Image& image, std::size_t first) {
  const SlottedEdge& run = slotted_[first];
  const auto first_edge = static_cast<std::uint32_t>(edges_.size());
  std::size_t i = first;
  for (; i < slotted_.size(); ++i) {
    const SlottedEdge& e = slotted_[i];
    if (e.bent || e.left != run.left || e.right != run.right) break;
    const FaceEdge& edge = polygon[e.edge];
    e.turned ? add_edge(image, edge.b, edge.a) : add_edge(image, edge.a, edge.b);
  }
  runs_.push_back({first_edge, static_cast<std::uint32_t>(edges_.size()) - first_edge, run.left, run.right, 0, 0});
  return i;
}

/// The chain of edges that starts with slotted_[first]. @return the first one after them
std::size_t PackedCells::add_bent_run(const FacePolygon& polygon, const Image& image, std::span<const EdgeBends> bends,
                                      std::size_t first) {
  const SlottedEdge& run = slotted_[first];
  const auto first_vertex = static_cast<std::uint32_t>(vertices_.size());
  const Eigen::Vector2d* last = nullptr;
  std::size_t i = first;
  for (; i < slotted_.size(); ++i) {
    const SlottedEdge& e = slotted_[i];
    const FaceEdge& edge = polygon[e.edge];
    const Eigen::Vector2d& a = e.turned ? edge.b : edge.a;
    const Eigen::Vector2d& b = e.turned ? edge.a : edge.b;
    if (e.left != run.left || e.right != run.right || (last != nullptr && a != *last)) break;
    if (last == nullptr) add_vertex(image, a, e.turned ? bends[e.edge].b : bends[e.edge].a);
    add_vertex(image, b, e.turned ? bends[e.edge].a : bends[e.edge].b);
    last = &b;
  }
  const auto count = static_cast<std::uint32_t>(vertices_.size()) - first_vertex - 1;
  const auto first_stretch = static_cast<std::uint32_t>(stretches_.size());
  add_stretches(vertices_, first_vertex, stretches_);
  const auto stretch_count = static_cast<std::uint32_t>(stretches_.size()) - first_stretch;
  runs_.push_back({first_vertex, count, run.left, run.right, first_stretch, stretch_count});
  return i;
}

}  // namespace sonoloft
