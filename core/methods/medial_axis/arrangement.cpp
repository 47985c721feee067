#include "core/methods/medial_axis/arrangement.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "core/cells/cell_complex.h"
#include "core/methods/network/data_box.h"

namespace sonoloft::medial {
namespace {

/// All that reaches to both sides of a plane is cut: cells are exact.
constexpr double kNoGap_mm = std::numeric_limits<double>::min();

bool has_unknown(const Section& section) {
  return section.border == kUnknown || std::ranges::any_of(section.edges, [](const SectionEdge& e) {
           return e.left == kUnknown || e.right == kUnknown;
         });
}

Result<std::vector<Section>> sections_of(std::span<const TrackedSlice> slices) {
  std::vector<Section> sections;
  for (std::size_t i = 0; i < slices.size(); ++i) {
    auto section = make_section(slices[i]);
    if (!section) return tl::unexpected<Error>(section.error());
    if (has_unknown(*section))
      return fail(ErrorCode::invalid_argument,
                  "medial-axis takes slices of any direction without unknown parts; slice " + std::to_string(i + 1) +
                      " has some: take straight-skeleton, or reconstruct without --method");
    sections.push_back(std::move(*section));
  }
  return sections;
}

/// Cells between planes alone: each plane is told as one label of its own, so that it cuts every cell that it meets.
class PlaneCells {
 public:
  explicit PlaneCells(const Eigen::AlignedBox3d& box) : complex_(box, kNoGap_mm) {
    complex_.faces(CellId{0}, faces_);
    for (const CellFace& face : faces_) frames_.push_back(*face.image_to_reference);
    sections_.resize(frames_.size(), nullptr);
  }

  /// Whether the plane of a slice cuts anything.
  Result<bool> add(const Section& slice, Label label) {
    Section plane;
    plane.image_to_reference = slice.image_to_reference;
    plane.border = label;
    const auto delta = complex_.insert(std::move(plane));
    if (!delta && delta.error().code == ErrorCode::outside_box) return false;
    if (!delta) return tl::unexpected<Error>(delta.error());
    if (delta->lower.empty()) return false;
    frames_.push_back(slice.image_to_reference);
    sections_.push_back(&slice);
    return true;
  }

  [[nodiscard]] std::span<const Eigen::Isometry3d> frames() const { return frames_; }
  [[nodiscard]] std::span<const Section* const> sections() const { return sections_; }

  /// The faces of a cell, and a point within each of these, unless one is too small for that.
  struct Faces {
    std::vector<Facing> facing;
    std::vector<Eigen::Vector2d> middles;
    bool has_middles = true;
  };
  std::vector<Faces> faces() {
    std::vector<Faces> all(complex_.cell_bound());
    for (std::size_t c = 0; c < all.size(); ++c) {
      complex_.faces(static_cast<CellId>(c), faces_);
      for (const CellFace& face : faces_) {
        all[c].facing.push_back({static_cast<std::uint32_t>(face.plane), face.above ? 1 : -1});
        Eigen::Vector2d sum = Eigen::Vector2d::Zero();
        for (const FaceEdge& e : *face.polygon) sum += e.a;
        all[c].middles.push_back(sum / static_cast<double>(face.polygon->size()));
        all[c].has_middles &= face.polygon->size() > 2;
      }
    }
    return all;
  }
  [[nodiscard]] const CellComplex& complex() const { return complex_; }

 private:
  CellComplex complex_;
  std::vector<CellFace> faces_;
  std::vector<Eigen::Isometry3d> frames_;  ///< [#planes]
  std::vector<const Section*> sections_;   ///< [#planes]
};

/// The face of a cell in which a piece of a contour lies, if it does.
std::optional<std::uint32_t> face_of(const CurveNetwork& network, const NetworkEdge& edge,
                                     std::span<const Facing> faces) {
  std::optional<std::uint32_t> own;
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    if (faces[i].plane == edge.plane)
      own = i;
    else if (network.edge_side(edge, faces[i].plane) != faces[i].side)
      return std::nullopt;
  }
  return own;
}

/// Pieces that lie in two planes are no business of any cell: they are where its faces meet.
bool lies_in_two(const CurveNetwork& network, const NetworkEdge& edge) {
  const auto &a = network.points[edge.a].on, &b = network.points[edge.b].on;
  return std::ranges::any_of(a, [&](std::uint32_t g) { return std::ranges::binary_search(b, g); });
}

/// @error the plane of a piece that does not lie between two cells
tl::expected<void, std::uint32_t> hand_out(const CurveNetwork& network, const CellComplex& complex,
                                           std::span<const PlaneCells::Faces> faces,
                                           std::vector<std::vector<FaceCurve>>& edges) {
  std::vector<CellId> near;
  for (std::uint32_t e = 0; e < network.edges.size(); ++e) {
    const NetworkEdge& edge = network.edges[e];
    if (lies_in_two(network, edge)) continue;
    near.clear();
    complex.touching(network.points[edge.a].position, network.points[edge.b].position, near);
    int found = 0;
    for (const CellId cell : near) {
      const auto c = static_cast<std::size_t>(cell);
      const auto face = face_of(network, edge, faces[c].facing);
      if (!face) continue;
      edges[c].push_back({*face, e});
      ++found;
    }
    if (found != 2) return tl::unexpected<std::uint32_t>(edge.plane);
  }
  return {};
}

/// Whether all faces of a cell without contours are known to have one label.
bool is_uniform(const CurveNetwork& network, const PlaneCells::Faces& faces) {
  if (!faces.has_middles) return false;
  const auto label = [&](std::size_t i) {
    const Eigen::Vector2d& p = faces.middles[i];
    return network.label_at(faces.facing[i].plane, Point(p.x(), p.y()), p);
  };
  const Label first = label(0);
  for (std::size_t i = 1; i < faces.facing.size(); ++i)
    if (label(i) != first) return false;
  return true;
}

}  // namespace

Result<Arrangement> arrange(std::span<const TrackedSlice> slices) {
  if (slices.size() >= kMaxLabel)
    return fail(ErrorCode::too_large,
                "medial-axis takes up to " + std::to_string(kMaxLabel - 1) + " slices: give fewer");
  auto sections = sections_of(slices);
  if (!sections) return tl::unexpected<Error>(sections.error());
  Arrangement out{.sections = std::move(*sections)};
  const Eigen::AlignedBox3d box = box_around(out.sections);
  if (box.isEmpty()) return fail(ErrorCode::empty_input, "no slice has a contour: segment the images first");
  out.scale_mm = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  for (const Section& s : out.sections)
    out.scale_mm = std::max(out.scale_mm, s.image_to_reference.translation().cwiseAbs().maxCoeff());

  PlaneCells cells(box);
  for (std::size_t i = 0; i < out.sections.size(); ++i) {
    const auto cuts = cells.add(out.sections[i], static_cast<Label>(i + 1));
    if (!cuts) return tl::unexpected<Error>(cuts.error());
    if (!*cuts && !out.sections[i].edges.empty())
      out.notes.push_back("slice " + std::to_string(i + 1) + " lies in the plane of one before: it was left out");
  }
  out.planes = std::make_unique<PlaneSet>(cells.frames(), out.scale_mm);
  out.network = std::make_unique<CurveNetwork>(*out.planes, cells.sections());
  const std::vector<PlaneCells::Faces> faces = cells.faces();
  std::vector<std::vector<FaceCurve>> edges(faces.size());
  if (const auto done = hand_out(*out.network, cells.complex(), faces, edges); !done) {
    const auto slice = out.network->sections[done.error()] - out.sections.data() + 1;
    return fail(ErrorCode::invalid_argument, "medial-axis takes slices whose planes differ; that of slice " +
                                                 std::to_string(slice) +
                                                 " nearly coincides with another: leave it out");
  }
  for (std::size_t c = 0; c < faces.size(); ++c) {
    if (faces[c].facing.empty() || (edges[c].empty() && is_uniform(*out.network, faces[c]))) continue;
    std::ranges::sort(edges[c], {}, [](const FaceCurve& e) { return std::pair{e.face, e.edge}; });
    out.cells.push_back({faces[c].facing, std::move(edges[c])});
  }
  return out;
}

}  // namespace sonoloft::medial
