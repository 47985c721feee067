#include <algorithm>
#include <charconv>
#include <limits>
#include <set>

#include "core/io/byte_file.h"
#include "core/io/slices/slice_files.h"

namespace sonoloft {
namespace {

using Loop = std::span<const Eigen::Vector2d>;

Loop loop_of(const TrackedSlice& slice, const Contour& contour) {
  return Loop(slice.points).subspan(contour.first, contour.count);
}

double area(Loop loop) {
  double twice = 0;
  for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
    const Eigen::Vector2d a = loop[j] - loop[0], b = loop[i] - loop[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return std::abs(twice) / 2;
}

bool encloses(Loop loop, const Eigen::Vector2d& p) {
  bool inside = false;
  for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
    const Eigen::Vector2d &a = loop[j], &b = loop[i];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()))
      inside = !inside;
  }
  return inside;
}

/// The number among the components of the smallest one around most of a hole; 0 where there is none.
std::size_t component_around(const TrackedSlice& slice, const std::vector<Contour>& components, const Contour& hole) {
  const Loop inner = loop_of(slice, hole);
  std::size_t around = 0;
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < components.size(); ++i) {
    const Loop outer = loop_of(slice, components[i]);
    const double outer_area = area(outer);
    if (components[i].hole || outer_area >= smallest || outer_area <= area(inner)) continue;
    const auto enclosed = std::count_if(inner.begin(), inner.end(), [&](const auto& p) { return encloses(outer, p); });
    if (2 * static_cast<std::size_t>(enclosed) < inner.size()) continue;
    around = i;
    smallest = outer_area;
  }
  return around;
}

class CslWriter {
 public:
  void add(const TrackedSlice& slice) {
    std::vector<Contour> components;
    for (const Contour& contour : slice.contours)
      if (contour.hole || contour.label != kUnknown)
        components.push_back(contour);
      else
        add_region("unknown ", slice, loop_of(slice, contour));
    if (!slice.field_of_view.empty()) add_region("view ", slice, slice.field_of_view);
    add_plane(slice, components);
    ++planes_;
  }

  [[nodiscard]] std::string finish() const {
    std::string text = "CSLC\n" + std::to_string(planes_) + ' ' + std::to_string(labels_.size()) + '\n' + plane_text_;
    if (regions_ > 0) text += "\nCSLX 1 " + std::to_string(regions_) + '\n' + region_text_;
    return text;
  }

 private:
  static void add_number(double value, std::string& text) {
    char digits[32];
    text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
  }

  static void add_points(const TrackedSlice& slice, Loop loop, std::string& text) {
    for (const Eigen::Vector2d& p : loop) {
      const Eigen::Vector3d at = slice.image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0);
      for (int axis = 0; axis < 3; ++axis) {
        add_number(at[axis], text);
        text += axis < 2 ? ' ' : '\n';
      }
    }
  }

  void add_region(const char* kind, const TrackedSlice& slice, Loop loop) {
    region_text_ += kind + std::to_string(planes_) + ' ' + std::to_string(loop.size()) + '\n';
    add_points(slice, loop, region_text_);
    ++regions_;
  }

  void add_plane(const TrackedSlice& slice, const std::vector<Contour>& components) {
    const Eigen::Vector3d normal = slice.image_to_reference.linear().col(2);
    std::size_t vertices = 0;
    for (const Contour& component : components) vertices += component.count;
    plane_text_ +=
        '\n' + std::to_string(planes_ + 1) + ' ' + std::to_string(vertices) + ' ' + std::to_string(components.size());
    for (const double value : {normal.x(), normal.y(), normal.z(), -normal.dot(slice.image_to_reference.translation())})
      add_number(value, plane_text_ += ' ');
    plane_text_ += '\n';
    for (const Contour& component : components) add_points(slice, loop_of(slice, component), plane_text_);
    std::size_t next = 0;
    for (const Contour& component : components) {
      plane_text_ += std::to_string(component.count);
      if (component.hole) plane_text_ += 'h' + std::to_string(component_around(slice, components, component));
      plane_text_ += ' ' + std::to_string(component.hole ? kOutside : component.label);
      for (std::uint32_t i = 0; i < component.count; ++i) plane_text_ += ' ' + std::to_string(next++);
      plane_text_ += '\n';
      if (!component.hole) labels_.insert(component.label);
    }
  }

  std::size_t planes_ = 0, regions_ = 0;
  std::set<Label> labels_;
  std::string plane_text_, region_text_;
};

}  // namespace

std::string csl_text(std::span<const TrackedSlice> slices) {
  CslWriter writer;
  for (const TrackedSlice& slice : slices) writer.add(slice);
  return writer.finish();
}

Result<void> write_csl(std::span<const TrackedSlice> slices, const std::filesystem::path& path) {
  return write_bytes(path, csl_text(slices));
}

}  // namespace sonoloft
