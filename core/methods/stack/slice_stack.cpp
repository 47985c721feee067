#include "core/methods/stack/slice_stack.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace sonoloft {
namespace {

constexpr double kMaxTilt_deg = 1;
/// Of the distance from the first slice to the last: slices nearer than that are at one height.
constexpr double kSameHeight = 1e-6;

using Eigen::Vector3d;

tl::unexpected<Error> not_for(const std::string& method, const std::string& what) {
  return fail(ErrorCode::invalid_argument, method + " takes two or more parallel slices without unknown parts; " +
                                               what +
                                               ": reconstruct without --method, which takes slices of any direction");
}

/// The middle of all contour points, axes of the first slice.
Result<Eigen::Isometry3d> stack_frame(std::span<const TrackedSlice> slices) {
  Eigen::AlignedBox3d box;
  for (const TrackedSlice& slice : slices)
    for (const Eigen::Vector2d& p : slice.points) box.extend(slice.image_to_reference * Vector3d(p.x(), p.y(), 0));
  if (box.isEmpty()) return fail(ErrorCode::empty_input, "no slice has a contour: segment the images first");
  Eigen::Isometry3d frame = slices[0].image_to_reference;
  frame.translation() = box.center();
  return frame;
}

bool has_unknown(const Section& section) {
  return section.border == kUnknown || std::ranges::any_of(section.edges, [](const SectionEdge& e) {
           return e.left == kUnknown || e.right == kUnknown;
         });
}

struct Placed {
  std::size_t slice;
  double height_mm;
  Section section;
};

/// The sections in the order of their heights, their labels and bounds.
void collect(std::vector<Placed> placed, SliceStack& stack) {
  std::set<Label> labels{kOutside};
  for (Placed& p : placed) {
    for (const SectionEdge& e : p.section.edges) labels.insert({e.left, e.right});
    for (const Eigen::Vector2d& point : p.section.points) stack.bounds.extend(point);
    stack.slices.push_back(p.slice);
    stack.heights_mm.push_back(p.height_mm);
    stack.sections.push_back(std::move(p.section));
  }
  stack.labels.assign(labels.begin(), labels.end());
}

}  // namespace

Result<void> check_slices(std::span<const TrackedSlice> slices) {
  for (const TrackedSlice& slice : slices)
    if (const auto section = make_section(slice); !section) return tl::unexpected<Error>(section.error());
  return {};
}

std::size_t first_oblique(std::span<const TrackedSlice> slices) {
  const auto normal = [&](std::size_t i) { return slices[i].image_to_reference.linear().col(2); };
  const double most = std::sin(kMaxTilt_deg * std::numbers::pi / 180);
  std::size_t i = 0;
  while (i < slices.size() && normal(0).cross(normal(i)).norm() <= most) ++i;
  return i;
}

Result<Section> section_in(const Eigen::Isometry3d& plane_to_reference, const TrackedSlice& slice, std::size_t number,
                           const std::string& method) {
  const Eigen::Isometry3d image_to_plane = plane_to_reference.inverse(Eigen::Isometry) * slice.image_to_reference;
  TrackedSlice moved = slice;
  for (std::vector<Eigen::Vector2d>* points : {&moved.points, &moved.field_of_view})
    for (Eigen::Vector2d& p : *points) p = (image_to_plane * Vector3d(p.x(), p.y(), 0)).head<2>();
  moved.image_to_reference = plane_to_reference;
  auto section = make_section(moved);
  if (section && has_unknown(*section)) return not_for(method, "slice " + std::to_string(number) + " has some");
  return section;
}

Result<SliceStack> make_stack(std::span<const TrackedSlice> slices, const std::string& method) {
  if (auto valid = check_slices(slices); !valid) return tl::unexpected<Error>(valid.error());
  if (slices.size() < 2) return not_for(method, "this is " + std::to_string(slices.size()));
  if (const std::size_t i = first_oblique(slices); i < slices.size())
    return not_for(method, "slice " + std::to_string(i + 1) + " is oblique to the first");
  const auto frame = stack_frame(slices);
  if (!frame) return tl::unexpected<Error>(frame.error());
  SliceStack stack;
  stack.stack_to_reference = *frame;
  const Eigen::Isometry3d reference_to_stack = frame->inverse(Eigen::Isometry);
  std::vector<Placed> placed;
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const double height_mm = (reference_to_stack * slices[i].image_to_reference.translation()).z();
    auto section = section_in(*frame * Eigen::Translation3d(0, 0, height_mm), slices[i], i + 1, method);
    if (!section) return tl::unexpected<Error>(section.error());
    section->image_to_reference = Eigen::Translation3d(0, 0, height_mm);
    placed.push_back({i + 1, height_mm, std::move(*section)});
  }
  std::ranges::sort(placed, {}, &Placed::height_mm);
  const double same = kSameHeight * (placed.back().height_mm - placed.front().height_mm);
  for (std::size_t i = 1; i < placed.size(); ++i)
    if (placed[i].height_mm - placed[i - 1].height_mm <= same)
      return not_for(method, "slices " + std::to_string(placed[i - 1].slice) + " and " +
                                 std::to_string(placed[i].slice) + " are at one height");
  collect(std::move(placed), stack);
  return stack;
}

}  // namespace sonoloft
