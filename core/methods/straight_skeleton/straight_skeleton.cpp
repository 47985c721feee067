#include "core/methods/straight_skeleton/straight_skeleton.h"

#include <algorithm>
#include <cmath>

#include "core/methods/network/data_box.h"
#include "core/methods/network/fairing/fairing.h"
#include "core/methods/network/fairing/refinement.h"
#include "core/methods/straight_skeleton/space/detours.h"
#include "core/methods/straight_skeleton/surface/assembly.h"
#include "core/slice/parallel.h"
#include "core/slice/section.h"

namespace sonoloft {
namespace {

using namespace skeleton;

/// Of the largest coordinate: what rounding leaves of two numbers that are meant to be one.
constexpr double kDoubt = 1e-11, kSamePlane = 1e-9;
/// Half-width of a box, in largest coordinates, that holds the feet of all points of the data's box.
constexpr double kUniverse = 8;
/// Of all fronts together: about a minute.
constexpr std::size_t kMaxCells = 10'000;
/// Triangles grow with the distance from the slices: beyond the rims surfaces are large, and nobody drew them.
constexpr double kGrowth = 0.25;

/// The front whose plane a slice lies in, to rounding.
Front* front_in_plane(std::deque<Front>& fronts, const Form& plane, const Eigen::AlignedBox3d& box, double same_mm) {
  for (Front& front : fronts) {
    const Eigen::Vector4d& of = front.maps.front().image.height->rough;
    const Eigen::Vector4d apart = plane.rough.head<3>().dot(of.head<3>()) > 0 ? Eigen::Vector4d(of - plane.rough)
                                                                              : Eigen::Vector4d(of + plane.rough);
    double most_mm = 0;
    for (int i = 0; i < 8; ++i)
      most_mm = std::max(
          most_mm, std::abs(apart.dot(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)).homogeneous())));
    if (most_mm < same_mm) return &front;
  }
  return nullptr;
}

bool has_labels(const Section& section) {
  const auto is_label = [](Label l) { return l != kOutside && l != kUnknown; };
  return std::ranges::any_of(section.edges,
                             [&](const SectionEdge& e) { return is_label(e.left) || is_label(e.right); });
}

Result<std::vector<Section>> sections_of(std::span<const TrackedSlice> slices) {
  std::vector<Section> sections;
  for (const TrackedSlice& slice : slices) {
    auto section = make_section(slice);
    if (!section) return tl::unexpected<Error>(section.error());
    sections.push_back(std::move(*section));
  }
  if (std::ranges::none_of(sections, has_labels))
    return fail(ErrorCode::empty_input, "no slice has a contour: segment the images first");
  return sections;
}

Result<Space> space_of(std::span<const Section> sections) {
  const Eigen::AlignedBox3d box = network::box_around(sections);
  double scale_mm = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  for (const Section& s : sections)
    scale_mm = std::max(scale_mm, s.image_to_reference.translation().cwiseAbs().maxCoeff());
  Space space{{}, ExactBox(box, kDoubt * scale_mm)};
  for (const Section& section : sections) {
    Eigen::Isometry3d frame = section.image_to_reference;
    Front* front = front_in_plane(space.fronts, *Image(frame).height, box, kSamePlane * scale_mm);
    if (front == nullptr) {
      front = &space.fronts.emplace_back();
    } else {
      const Eigen::Vector3d normal = front->maps.front().image.height->rough.head<3>();
      frame.linear().col(2) = frame.linear().col(2).dot(normal) > 0 ? normal : Eigen::Vector3d(-normal);
    }
    front->maps.emplace_back(section, Image(frame));
  }
  const Eigen::Vector3d far = Eigen::Vector3d::Constant(kUniverse * scale_mm);
  const ExactBox universe({-far, far}, space.box.doubt_mm);
  std::size_t cells = 0;
  for (Front& front : space.fronts) {
    const bool few = find_footings(front, universe, 2 * kUniverse * scale_mm);
    if (!few || (cells += front.cells.size()) > kMaxCells)
      return fail(
          ErrorCode::too_large,
          "straight-skeleton takes fields of view and shadows with few bends inwards; these have too many: draw "
          "them with fewer corners, or reconstruct without --method");
  }
  for (const FormPtr& wall : space.box.walls) space.fronts.push_back(front_of_wall(wall));
  return space;
}

std::vector<Facet> facets_of(const Space& space, int threads) {
  std::vector<Owner> owners;
  for (std::uint32_t f = 0; f + 6 < space.fronts.size(); ++f)
    for (const FrontCell& cell : space.fronts[f].cells) owners.push_back({f, &cell});
  std::vector<std::vector<Facet>> parts(owners.size());
  parallel_for(owners.size(), 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t o = first; o < last; ++o) {
      parts[o] = sheets(space, owners[o]);
      std::ranges::move(uprights(space, owners[o]), std::back_inserter(parts[o]));
    }
  });
  std::vector<Facet> all;
  for (std::vector<Facet>& part : parts) std::ranges::move(part, std::back_inserter(all));
  return all;
}

Result<MethodSurfaces> run(const MethodInput& input) {
  auto surfaces = straight_skeleton(input.slices, {input.settings.at("fairing") == "on", input.threads});
  if (!surfaces) return tl::unexpected<Error>(surfaces.error());
  return as_mesh(std::move(*surfaces));
}

}  // namespace

Result<ContourSurfaces> straight_skeleton(std::span<const TrackedSlice> slices,
                                          const StraightSkeletonOptions& options) {
  const auto sections = sections_of(slices);
  if (!sections) return tl::unexpected<Error>(sections.error());
  const auto space = space_of(*sections);
  if (!space) return tl::unexpected<Error>(space.error());
  const std::vector<Facet> facets = facets_of(*space, options.threads);
  Assembly assembly = assemble(*space, facets, options.threads);
  network::JoinedCells& joined = assembly.cells;
  if (const std::size_t count = count_detours(*space, assembly.used); count > 0)
    joined.surfaces.notes.push_back(std::to_string(count) + " of " + std::to_string(assembly.used.size()) +
                                    " facets lie where a front could only come through another one: there the nearest "
                                    "patch decides, as in medial-axis");
  if (options.fairing) {
    network::refine(joined, kGrowth);
    if (!network::fair(joined)) joined.surfaces.notes.emplace_back("the surfaces could not be made smooth");
  }
  return std::move(joined.surfaces);
}

Method straight_skeleton_method() {
  return {"straight-skeleton",
          "slices of any direction, also with unknown parts, one or many labels",
          {{"fairing", "whether the surfaces are made smooth between the slices", "on", {"on", "off"}}},
          run};
}

}  // namespace sonoloft
