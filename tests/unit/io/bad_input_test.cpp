// One table of what goes wrong with files and slices, and what is made of it.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/io/slices/slice_files.h"
#include "core/slice/section.h"

using namespace sonoloft;
using Eigen::Vector2d;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Case {
  std::string input;
  std::string expected;  ///< an error code, or the repair
  std::function<std::string()> outcome;
};

std::string of(const Result<SliceFile>& file) {
  if (!file) {
    CHECK(file.error().message.find('\n') == std::string::npos);
    CHECK_MESSAGE(file.error().message.find(": ") != std::string::npos, file.error().message);
    return name(file.error().code);
  }
  std::string repairs;
  const auto note = [&](const char* what, auto count) {
    if (count) repairs += (repairs.empty() ? "" : ", ") + std::string(what);
  };
  note("normal scaled", file->notes.scaled_normals);
  note("sign of D turned", file->notes.flipped_offsets);
  note("sides exchanged", file->notes.flipped_sides);
  note("planes merged", file->notes.merged_planes);
  note("vertices projected", file->notes.moved_vertices);
  note("component dropped", file->notes.dropped_components);
  note("trailing text ignored", file->notes.trailing_text);
  for (const TrackedSlice& slice : file->slices) CHECK(make_section(slice).has_value());
  return repairs.empty() ? "read as it is" : repairs;
}

Case csl(std::string input, std::string expected, std::string text) {
  return {"csl: " + std::move(input), std::move(expected), [text] { return of(parse_csl(text, "t.csl")); }};
}

Case contour(std::string input, std::string expected, std::string text) {
  return {".contour: " + std::move(input), std::move(expected),
          [text] { return of(parse_contour(text, "t.contour")); }};
}

TrackedSlice square() {
  TrackedSlice slice;
  slice.points = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
  slice.contours = {{0, 4, 1, false}};
  return slice;
}

Case slice(std::string input, std::string expected, const std::function<void(TrackedSlice&)>& harm) {
  return {"slice: " + std::move(input), std::move(expected), [harm]() -> std::string {
            TrackedSlice s = square();
            harm(s);
            const auto section = make_section(s);
            if (!section) return name(section.error().code);
            return std::to_string(section->edges.size()) + " edges, " + std::to_string(section->repaired_crossings) +
                   " crossings";
          }};
}

/// A valid plane z = 0 with one triangle; parts are replaced to harm it.
std::string with(const std::string& from = "", const std::string& to = "") {
  std::string text = "CSLC\n1 1\n1 3 1 0 0 1 0\n0 0 0\n4 0 0\n0 4 0\n3 1 0 1 2\n";
  if (!from.empty()) text.replace(text.find(from), from.size(), to);
  return text;
}

/// The same with a field of view and an unknown region.
std::string seen(const std::string& from = "", const std::string& to = "") {
  std::string text = with() + "CSLX 1 2\nview 0 3\n-9 -9 0\n9 -9 0\n0 9 0\nunknown 0 3\n1 1 0\n2 1 0\n1 2 0\n";
  if (!from.empty()) text.replace(text.find(from), from.size(), to);
  return text;
}

std::string soup(const std::string& from = "", const std::string& to = "") {
  std::string text = "1\n0 0 1 0\n3 3\n0 0 0\n4 0 0\n0 4 0\n0 1 1 0\n1 2 1 0\n2 0 1 0\n";
  if (!from.empty()) text.replace(text.find(from), from.size(), to);
  return text;
}

std::vector<Case> file_cases() {
  std::string star = "1\n0 0 1 0\n131 130\n0 0 0\n";
  std::string spokes;
  for (int k = 0; k < 130; ++k) {
    star += std::to_string(k) + " 1 0\n";
    spokes += k % 2 ? std::to_string(k + 1) + " 0 1 0\n" : "0 " + std::to_string(k + 1) + " 1 0\n";
  }
  return {
      csl("as it should be", "read as it is", with()),
      csl("empty file", "empty_input", ""),
      csl("blank lines only", "empty_input", " \r\n\n "),
      csl("another kind of file", "unsupported_format", "ply\nformat ascii 1.0\n"),
      csl("ends in the header", "parse_failed", "CSLC\n1"),
      csl("ends in the vertices", "parse_failed", "CSLC\n1 1\n1 3 1 0 0 1 0\n0 0 0\n4 0"),
      csl("ends in a component", "parse_failed", with("3 1 0 1 2\n", "3 1 0 1")),
      csl("more planes declared than there are", "parse_failed", with("1 1\n", "2 1\n")),
      csl("10^12 planes declared", "too_large", with("1 1\n", "1000000000000 1\n")),
      csl("10^12 vertices declared", "too_large", with("1 3 1", "1 1000000000000 1")),
      csl("a million vertices declared, three there", "parse_failed", with("1 3 1", "1 1000000 1")),
      csl("10^30 vertices declared", "too_large", with("1 3 1", "1 1000000000000000000000000000000 1")),
      csl("10^12 components declared", "too_large", with("1 3 1", "1 3 1000000000000")),
      csl("10^12 vertices in a component", "too_large", with("3 1 0", "1000000000000 1 0")),
      csl("-3 vertices declared", "parse_failed", with("1 3 1", "1 -3 1")),
      csl("nan as a coordinate", "non_finite", with("4 0 0", "nan 0 0")),
      csl("1e999 as a coordinate", "non_finite", with("4 0 0", "1e999 0 0")),
      csl("inf as the plane's constant", "non_finite", with("0 0 1 0\n", "0 0 1 inf\n")),
      csl("1e200 as a coordinate", "bad_contour", with("4 0 0", "1e200 0 0")),
      csl("a word as a coordinate", "parse_failed", with("4 0 0", "4,0 0 0")),
      csl("a normal of zero", "parse_failed", with("0 0 1 0\n", "0 0 0 0\n")),
      csl("a normal of length 2", "normal scaled", with("0 0 1 0\n", "0 0 2 0\n")),
      csl("the wrong sign of D", "sign of D turned", "CSLC\n1 1\n1 3 1 0 0 1 7\n0 0 7\n4 0 7\n0 4 7\n3 1 0 1 2\n"),
      csl("a field of view and an unknown region", "read as it is", seen()),
      csl("an extension of version 2", "unsupported_format", seen("CSLX 1", "CSLX 2")),
      csl("an extension of version 0", "unsupported_format", seen("CSLX 1", "CSLX 0")),
      csl("an extension without a version", "parse_failed", with() + "CSLX"),
      csl("more regions declared than there are", "parse_failed", seen("CSLX 1 2", "CSLX 1 3")),
      csl("10^12 regions declared", "too_large", seen("CSLX 1 2", "CSLX 1 1000000000000")),
      csl("a region of another kind", "parse_failed", seen("unknown", "shadow")),
      csl("a region of a plane that is not there", "parse_failed", seen("unknown 0", "unknown 1")),
      csl("a region of 2 vertices", "bad_contour", seen("view 0 3\n-9 -9 0", "view 0 2")),
      csl("a million vertices of a region declared", "parse_failed", seen("view 0 3", "view 0 1000000")),
      csl("two views of a plane", "parse_failed", seen("unknown", "view")),
      csl("ends in a region", "parse_failed", seen("\n1 2 0\n", "\n1")),
      csl("nan in a region", "non_finite", seen("9 -9 0", "9 nan 0")),
      csl("a region far off its plane", "non_planar", seen("0 9 0\nu", "0 9 3\nu")),
      csl("an extension without a plane", "empty_input", "CSLC\n0 1\nCSLX 1 0\n"),
      csl("a vertex far off its plane", "non_planar", with("4 0 0", "4 0 0.5")),
      csl("a vertex a little off its plane", "vertices projected", with("4 0 0", "4 0 0.01")),
      csl("a vertex number too high", "parse_failed", with("0 1 2\n", "0 1 3\n")),
      csl("a label too high", "bad_contour", with("3 1 0 1 2", "3 70000 0 1 2")),
      csl("a negative label", "parse_failed", with("3 1 0 1 2", "3 -1 0 1 2")),
      csl("a component of one vertex beside another", "component dropped",
          with("1 3 1 0", "1 3 2 0").append("1 1 0\n")),
      csl("no component at all", "empty_input", "CSLC\n1 1\n1 0 0 0 0 1 0\n"),
      csl("a component without vertices to name", "parse_failed", "CSLC\n1 1\n1 0 1 0 0 1 0\n3 1 0 1 2\n"),
      csl("the same plane twice", "planes merged", with("1 1\n", "2 1\n") + with().substr(9)),
      csl("text behind the last plane", "trailing text ignored", with() + "7 8 9"),
      contour("as it should be", "read as it is", soup()),
      contour("empty file", "empty_input", "\n"),
      contour("a word as the number of planes", "parse_failed", "CSLC 1"),
      contour("left and right exchanged", "sides exchanged",
              "1\n0 0 1 0\n3 3\n0 0 0\n4 0 0\n0 4 0\n0 1 0 1\n1 2 0 1\n2 0 0 1\n"),
      contour("a border that does not close", "bad_contour", soup("2 0 1 0", "2 1 1 0")),
      contour("an edge missing", "bad_contour", "1\n0 0 1 0\n3 2\n0 0 0\n4 0 0\n0 4 0\n0 1 1 0\n1 2 1 0\n"),
      contour("equal labels on both sides everywhere", "empty_input",
              "1\n0 0 1 0\n3 3\n0 0 0\n4 0 0\n0 4 0\n0 1 1 1\n1 2 1 1\n2 0 1 1\n"),
      contour("a vertex number too high", "parse_failed", soup("1 2 1 0", "1 9 1 0")),
      contour("a label too high", "bad_contour", soup("1 2 1 0", "1 2 99999 0")),
      contour("10^12 edges declared", "too_large", soup("3 3\n", "3 1000000000000\n")),
      contour("ends in the edges", "parse_failed", soup("2 0 1 0\n", "2 0")),
      contour("65 borders from one vertex", "bad_contour", star + spokes),
  };
}

std::vector<Case> slice_cases() {
  return {
      slice("as it should be", "4 edges, 0 crossings", [](TrackedSlice&) {}),
      slice("a contour of two points", "bad_contour", [](TrackedSlice& s) { s.contours[0].count = 2; }),
      slice("a contour beyond the points", "bad_contour", [](TrackedSlice& s) { s.contours[0].first = 1; }),
      slice("a contour whose end overflows", "bad_contour",
            [](TrackedSlice& s) {
              s.contours[0] = {0xFFFFFFFF, 0xFFFFFFFF, 1, false};
            }),
      slice("a reserved label", "bad_contour", [](TrackedSlice& s) { s.contours[0].label = 0xFFFE; }),
      slice("NaN in a point", "non_finite", [](TrackedSlice& s) { s.points[2].y() = kNaN; }),
      slice("infinity in the field of view", "non_finite",
            [](TrackedSlice& s) {
              s.field_of_view = {{0, 0}, {1, 0}, {0, HUGE_VAL}};
            }),
      slice("a field of view of two points", "bad_contour",
            [](TrackedSlice& s) {
              s.field_of_view = {{0, 0}, {1, 0}};
            }),
      slice("a point at 1e300", "bad_contour", [](TrackedSlice& s) { s.points[0].x() = 1e300; }),
      slice("a pose with a scale", "not_rigid", [](TrackedSlice& s) { s.image_to_reference.linear() *= 1.00001; }),
      slice("a mirrored pose", "not_rigid", [](TrackedSlice& s) { s.image_to_reference.linear().col(2) *= -1; }),
      slice("NaN in the pose", "non_finite", [](TrackedSlice& s) { s.image_to_reference.translation().x() = kNaN; }),
      slice("a pose a light-second away", "bad_contour",
            [](TrackedSlice& s) { s.image_to_reference.translation().x() = 3e11; }),
      slice("2^20 + 1 points", "too_large",
            [](TrackedSlice& s) {
              s.points.resize(kMaxSlicePoints + 1, Vector2d::Zero());
              s.contours[0].count = kMaxSlicePoints + 1;
            }),
      slice("2^14 + 1 contours", "too_large",
            [](TrackedSlice& s) { s.contours.resize(kMaxSliceContours + 1, s.contours[0]); }),
      slice("2^14 contours of one place", "4 edges, 0 crossings",
            [](TrackedSlice& s) { s.contours.resize(kMaxSliceContours, s.contours[0]); }),
      slice("all points in one place", "0 edges, 0 crossings",
            [](TrackedSlice& s) { s.points.assign(4, Vector2d(1, 1)); }),
      slice("points closer than any number", "4 edges, 0 crossings",
            [](TrackedSlice& s) {
              for (Vector2d& p : s.points) p *= 1e-120;
            }),
      slice("a contour that crosses itself", "6 edges, 1 crossings",
            [](TrackedSlice& s) { std::swap(s.points[2], s.points[3]); }),
      slice("2^14 equal contours, crossed 100,000 times", "too_large",
            [](TrackedSlice& s) {
              s.contours.resize(kMaxSliceContours, s.contours[0]);
              s.contours.back() = {4, 100000, 2, false};
              for (int k = 0; k < 100000; ++k) s.points.emplace_back(4e-5 * k, k % 2 ? -1 : 1);
            }),
      slice("long strokes that all cross each other", "too_large",
            [](TrackedSlice& s) {
              s.points.clear();
              for (int k = 0; k < 2000; ++k)
                s.points.emplace_back(100 * std::cos(2.0 * k), 100 * std::sin(2.0 * k + 1e-3 * k));
              s.contours[0].count = 2000;
            }),
  };
}

}  // namespace

TEST_CASE("bad input: each of more than 60 kinds has its stated error or its stated repair") {
  std::vector<Case> cases = file_cases();
  for (Case& c : slice_cases()) cases.push_back(std::move(c));
  for (const Case& c : cases) {
    const std::string outcome = c.outcome();
    std::printf("  %-56s %s\n", c.input.c_str(), outcome.c_str());
    CHECK_MESSAGE(outcome == c.expected, c.input);
  }
  CHECK(cases.size() > 60);
}
