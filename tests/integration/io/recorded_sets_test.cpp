// Recorded slices of others, each with its traps: read, and made into sections.
#include "tests/support/recorded_sets.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <string>

#include "core/io/meshes/mesh_files.h"
#include "core/io/slices/slice_files.h"
#include "core/slice/section.h"
#include "tests/support/slice_truth.h"

using namespace sonoloft;
using namespace sonoloft::test;
using Eigen::Vector2d;

namespace {

std::vector<Section> sections_of(const SliceFile& file) {
  std::vector<Section> sections;
  for (const TrackedSlice& slice : file.slices) {
    auto section = make_section(slice);
    REQUIRE_MESSAGE(section.has_value(), (section ? "" : section.error().message));
    sections.push_back(std::move(*section));
  }
  return sections;
}

std::set<Label> labels_of(const std::vector<Section>& sections) {
  std::set<Label> labels;
  for (const Section& section : sections)
    for (const SectionEdge& e : section.edges) labels.insert({e.left, e.right});
  labels.erase(kOutside);
  return labels;
}

std::size_t point_count(const std::vector<Section>& sections) {
  std::size_t count = 0;
  for (const Section& section : sections) count += section.points.size();
  return count;
}

/// Groups of planes whose normals are parallel to 0.3 degrees.
std::size_t direction_count(const SliceFile& file) {
  std::vector<Eigen::Vector3d> directions;
  for (const TrackedSlice& slice : file.slices) {
    const Eigen::Vector3d n = slice.image_to_reference.linear().col(2);
    const auto parallel = [&](const Eigen::Vector3d& d) { return std::abs(d.dot(n)) > std::cos(0.3 * M_PI / 180); };
    if (std::none_of(directions.begin(), directions.end(), parallel)) directions.push_back(n);
  }
  return directions.size();
}

double labelled_area(const Section& section) {
  double area = 0;
  for (const SectionEdge& e : section.edges) {
    const Vector2d &a = section.points[e.a], &b = section.points[e.b];
    area += 0.5 * ((e.left != kOutside) - (e.right != kOutside)) * (a.x() * b.y() - a.y() * b.x());
  }
  return area;
}

struct Expected {
  std::string file;
  std::size_t planes, vertices, labels;
  double largest_offset;  ///< of vertices from their planes, as a share of the diagonal
};

}  // namespace

TEST_CASE("recorded sets: ten CSL files have the planes, vertices and labels that they are known for") {
  const Expected table[] = {
      {"Abdomen.csl", 42, 32682, 9, 1e-8},   {"Heart-25-even-better.csl", 25, 4534, 1, 1e-8},
      {"Horsers.csl", 29, 4101, 1, 6e-5},    {"ParallelEight.csl", 20, 1156, 1, 1e-8},
      {"SideBishop.csl", 10, 1376, 1, 1e-8}, {"Vetebrae.csl", 36, 14815, 1, 1e-8},
      {"eight_15.csl", 15, 2028, 1, 1e-8},   {"eight_20.csl", 20, 3178, 1, 1e-8},
      {"hand_ok.csl", 15, 4082, 1, 1e-8},    {"rose.csl", 15, 9000, 1, 1e-8},
  };
  for (const Expected& expected : table) {
    const auto path = recorded_set(std::filesystem::path("csl") / expected.file);
    if (!path) continue;
    INFO(expected.file);
    const auto file = read_csl(*path);
    REQUIRE_MESSAGE(file.has_value(), (file ? "" : file.error().message));
    const auto start = std::chrono::steady_clock::now();
    const std::vector<Section> sections = sections_of(*file);
    const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
    MESSAGE(expected.file, ": ", direction_count(*file), " directions; sections took ", taken.count(), " ms");
    CHECK(sections.size() == expected.planes);
    CHECK(point_count(sections) == expected.vertices);
    CHECK(labels_of(sections).size() == expected.labels);
    Eigen::AlignedBox3d box;
    double smallest_area = 1e300;
    for (std::size_t k = 0; k < sections.size(); ++k) {
      if (!sections[k].edges.empty()) smallest_area = std::min(smallest_area, labelled_area(sections[k]));
      for (const Vector2d& p : sections[k].points)
        box.extend(sections[k].image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0));
    }
    CHECK(smallest_area > 0);
    CHECK(file->notes.largest_offset_mm <= expected.largest_offset * box.diagonal().norm());
    CHECK(file->notes.dropped_components == 0);
    CHECK_FALSE(file->notes.trailing_text);
  }
}

TEST_CASE("recorded sets: each trap is noticed") {
  const auto notes = [](const std::string& name) -> std::optional<SliceFileNotes> {
    const auto path = recorded_set(std::filesystem::path("csl") / name);
    if (!path) return std::nullopt;
    return read_csl(*path)->notes;
  };
  if (const auto rose = notes("rose.csl")) CHECK(rose->flipped_offsets == 14);  // the 15th goes through the origin
  if (const auto horses = notes("Horsers.csl")) {
    CHECK(horses->scaled_normals == 10);
    CHECK(horses->moved_vertices > 1000);
  }
  const auto path = recorded_set("csl/Abdomen.csl");
  if (!path) return;
  const auto abdomen = read_csl(*path);
  std::size_t holes = 0;
  for (const TrackedSlice& slice : abdomen->slices)
    holes += static_cast<std::size_t>(
        std::count_if(slice.contours.begin(), slice.contours.end(), [](const Contour& c) { return c.hole; }));
  CHECK(holes == 484);
}

TEST_CASE("recorded sets: a slice of the abdomen has the label that the rule gives at every point") {
  const auto path = recorded_set("csl/Abdomen.csl");
  if (!path) return;
  const auto file = read_csl(*path);
  std::size_t checked = 0, wrong = 0;
  for (std::size_t k = 0; k < file->slices.size(); k += 6) {
    const TrackedSlice& slice = file->slices[k];
    const SliceTruth truth(slice);
    const auto section = make_section(slice);
    Eigen::AlignedBox2d box;
    for (const Vector2d& p : slice.points) box.extend(p);
    for (int i = 0; i < 300; ++i) {
      const Vector2d p =
          box.min() + Vector2d(std::fmod(i * 0.754877666, 1), std::fmod(i * 0.569840291, 1)).cwiseProduct(box.sizes());
      if (truth.distance_to_border(p) < 1e-6) continue;
      ++checked;
      wrong += label_at(*section, p) != truth.label_at(p);
    }
  }
  CHECK(checked > 2000);
  CHECK(wrong == 0);
}

TEST_CASE("recorded sets: curve networks keep every edge with the labels of its two sides") {
  const std::map<std::string, std::pair<std::size_t, std::size_t>> table{{"mousebrain", {1874, 38}},
                                                                         {"ringc", {280, 4}}};
  for (const auto& row : table) {
    const auto path = recorded_set("contour/" + row.first + ".contour");
    if (!path) continue;
    INFO(row.first);
    const auto expected = row.second;
    const auto file = read_contour(*path);
    REQUIRE_MESSAGE(file.has_value(), (file ? "" : file.error().message));
    const std::vector<Section> sections = sections_of(*file);
    CHECK(point_count(sections) == expected.first);
    CHECK(file->notes.flipped_sides == 0);

    std::size_t junctions = 0;
    std::ifstream text(*path);
    std::size_t planes = 0;
    text >> planes;
    REQUIRE(sections.size() == planes);
    for (const Section& section : sections) {
      std::vector<int> degree(section.points.size(), 0);
      std::map<std::pair<Label, Label>, int> pairs;
      for (const SectionEdge& e : section.edges) {
        ++degree[e.a], ++degree[e.b];
        ++pairs[std::minmax(e.left, e.right)];
      }
      junctions += static_cast<std::size_t>(std::count_if(degree.begin(), degree.end(), [](int d) { return d >= 3; }));
      double skip;
      std::size_t vertices, edges;
      text >> skip >> skip >> skip >> skip >> vertices >> edges;
      for (std::size_t k = 0; k < 3 * vertices; ++k) text >> skip;
      for (std::size_t k = 0; k < edges; ++k) {
        Label left, right;
        text >> skip >> skip >> left >> right;
        --pairs[std::minmax(left, right)];
      }
      REQUIRE(text.good());
      for (const auto& surplus : pairs)
        CHECK_MESSAGE(surplus.second == 0, "labels ", surplus.first.first, " and ", surplus.first.second);
    }
    CHECK(junctions == expected.second);
  }
  const auto path = recorded_set("contour/ringc.contour");
  if (path) CHECK(read_contour(*path)->notes.flipped_offsets == 2);  // two of its planes go through the origin
}

TEST_CASE("recorded sets: the scans behind two of the sets are closed meshes of their genus") {
  const std::map<std::string, long> euler_number{{"eight_20_scaled.stl", -2}, {"hand_ok_scaled.stl", 0}};
  for (const auto& row : euler_number) {
    const auto path = recorded_set("truth/" + row.first);
    if (!path) continue;
    INFO(row.first);
    const auto mesh = read_mesh(*path);
    REQUIRE_MESSAGE(mesh.has_value(), (mesh ? "" : mesh.error().message));
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const auto& t : mesh->triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3];
        edges[std::minmax(a, b)] += a < b ? 1 : -1;
      }
    CHECK(std::all_of(edges.begin(), edges.end(), [](const auto& e) { return e.second == 0; }));
    CHECK(static_cast<long>(mesh->positions.size()) - static_cast<long>(edges.size()) +
              static_cast<long>(mesh->triangles.size()) ==
          row.second);
  }
}
