#include <string>

#include "core/io/byte_file.h"
#include "core/io/slices/slice_file_builder.h"
#include "core/io/text_scanner.h"
#include "core/slice/section.h"

namespace sonoloft {
namespace {

/// `n[hP] label i0 i1 ...`: P, the component around a hole, is not needed: the smallest enclosing contour decides.
FileLoop read_component(TextScanner& in, std::size_t vertex_count) {
  FileLoop loop{};
  const std::string_view head = in.word("a component's number of vertices");
  const std::size_t digits = std::min(head.find('h'), head.size());
  loop.hole = digits < head.size();
  const std::uint64_t count =
      in.whole_from(head.substr(0, digits), "a component's number of vertices", kMaxSlicePoints, ErrorCode::too_large);
  if (loop.hole && head.size() > digits + 1)
    (void)in.whole_from(head.substr(digits + 1), "the component around a hole", kMaxSliceContours,
                        ErrorCode::parse_failed);
  if (loop.hole)
    (void)in.real("a hole's label");
  else
    loop.label = static_cast<Label>(in.whole("a component's label", kMaxLabel, ErrorCode::bad_contour));
  for (std::uint64_t k = 0; k < count && !in.failed(); ++k) {
    if (vertex_count == 0) {
      in.set_error(ErrorCode::parse_failed, "a component in a plane without vertices: mend the line");
      break;
    }
    loop.vertices.push_back(
        static_cast<std::uint32_t>(in.whole("a vertex number", vertex_count - 1, ErrorCode::parse_failed)));
  }
  return loop;
}

/// `view|unknown plane n`, then n vertices, which join those of the plane.
void read_region(TextScanner& in, std::vector<FilePlane>& planes, std::vector<std::vector<FileLoop>>& loops) {
  const std::string_view kind = in.word("a region's kind");
  const auto k = static_cast<std::size_t>(in.whole("a region's plane", planes.size() - 1, ErrorCode::parse_failed));
  if (in.failed()) return;
  if (kind != "view" && kind != "unknown")
    return in.set_error(ErrorCode::parse_failed, "a region is neither view nor unknown: mend the line");
  if (kind == "view" && !planes[k].view.empty())
    return in.set_error(ErrorCode::parse_failed, "a second view of one plane: give each image a plane of its own");
  const std::size_t count = in.count("a region's number of vertices", kMaxSlicePoints, 6);
  if (!in.failed() && count < 3)
    return in.set_error(ErrorCode::bad_contour, "a region of fewer than 3 vertices: leave it out");
  FileLoop region{{}, kUnknown, false};
  for (std::size_t i = 0; i < count && !in.failed(); ++i) {
    region.vertices.push_back(static_cast<std::uint32_t>(planes[k].vertices.size()));
    planes[k].vertices.push_back(in.vector("a coordinate"));
  }
  if (kind == "view")
    planes[k].view = std::move(region.vertices);
  else
    loops[k].push_back(std::move(region));
}

/// `CSLX 1 count`, then regions. Plain readers stop before it.
/// @return whether it is there; else nothing was read but the first word
bool read_extension(TextScanner& in, std::vector<FilePlane>& planes, std::vector<std::vector<FileLoop>>& loops) {
  if (in.word("the extension") != "CSLX") return false;
  if (in.whole("the extension's version", 1, ErrorCode::unsupported_format) != 1)
    in.set_error(ErrorCode::unsupported_format, "the extension's version is not 1: export the file for version 1");
  const std::size_t count = in.count("the number of regions", 2 * kMaxFileSlices * kMaxSliceContours, 20);
  for (std::size_t i = 0; i < count && !in.failed(); ++i) read_region(in, planes, loops);
  return true;
}

}  // namespace

Result<SliceFile> parse_csl(std::string_view text, std::string_view name) {
  TextScanner in(text, name);
  if (in.at_end()) return fail(ErrorCode::empty_input, std::string(name) + ": the file is empty");
  if (in.word("CSLC") != "CSLC")
    return fail(ErrorCode::unsupported_format, std::string(name) + ": does not begin with CSLC: not a CSL file");
  const std::size_t plane_count = in.count("the number of planes", kMaxFileSlices, 14);
  (void)in.real("the number of labels");  // often wrong: the components tell

  SliceFileNotes notes;
  std::vector<FilePlane> planes;
  std::vector<std::vector<FileLoop>> loops;
  for (std::size_t i = 0; i < plane_count && !in.failed(); ++i) {
    (void)in.real("a plane's number");
    FilePlane& plane = planes.emplace_back();
    plane.line = in.line();
    const std::size_t vertex_count = in.count("a number of vertices", kMaxSlicePoints, 6);
    const std::size_t component_count = in.count("a number of components", kMaxSliceContours, 4);
    plane.normal = in.vector("a plane's normal");
    plane.offset = in.real("a plane's constant");
    for (std::size_t k = 0; k < vertex_count && !in.failed(); ++k) plane.vertices.push_back(in.vector("a coordinate"));
    auto& plane_loops = loops.emplace_back();
    for (std::size_t k = 0; k < component_count && !in.failed(); ++k) {
      FileLoop loop = read_component(in, vertex_count);
      if (loop.vertices.size() < 3)
        ++notes.dropped_components;
      else
        plane_loops.push_back(std::move(loop));
    }
  }
  if (!in.failed() && !in.at_end() && !planes.empty())
    notes.trailing_text = !read_extension(in, planes, loops) || !in.at_end();
  if (in.failed()) return in.failure();
  if (auto ok = place_planes(planes, std::string(name), notes); !ok) return tl::unexpected(ok.error());
  return build_slices(planes, loops, std::string(name), notes);
}

Result<SliceFile> read_csl(const std::filesystem::path& path) {
  return read_bytes(path).and_then([&](const std::string& text) { return parse_csl(text, path.filename().string()); });
}

}  // namespace sonoloft
