#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "core/io/meshes/mesh_files.h"
#include "tests/integration/tool/tool_run.h"
#include "tests/support/twin_boxes.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

bool can(const std::string& command) {
  return std::system(command.c_str()) == 0;
}

/// Debian's Python, which has what its packages bring; another one may come first in the path.
constexpr const char* kPython = "/usr/bin/python3 -B ";

bool has_vtk() {
  static const bool has = can(std::string(kPython) + "-c 'import vtk, numpy' 2>/dev/null");
  if (!has) MESSAGE("SKIP: no VTK in python3: apt install python3-vtk9");
  return has;
}

nlohmann::json facts_of(const std::filesystem::path& file, const TemporaryFolder& folder) {
  const std::string out = folder.path("facts.json").string(), err = folder.path("facts.err").string();
  const std::string script = std::filesystem::absolute("tests/integration/formats/mesh_facts.py").string();
  REQUIRE_MESSAGE(can(kPython + script + ' ' + file.string() + " >" + out + " 2>" + err), bytes_of(err));
  return json_of(out);
}

LabelTable two_names() {
  LabelTable labels;
  REQUIRE(labels.add(2, "left kidney", {10, 200, 30}));
  REQUIRE(labels.add(5, "spleen", {250, 0, 125}));
  return labels;
}

/// Writes the mesh in all four formats. @return their files by their endings
std::map<std::string, std::filesystem::path> write_all(const IndexedMesh& mesh, const LabelTable& labels,
                                                       const TemporaryFolder& folder) {
  std::map<std::string, std::filesystem::path> files;
  for (const char* ending : {"ply", "stl", "obj", "vtp"}) files[ending] = folder.path(std::string("mesh.") + ending);
  REQUIRE(write_ply(mesh, files["ply"], labels));
  REQUIRE(write_stl(mesh, files["stl"]));
  REQUIRE(write_obj(mesh, files["obj"], labels));
  REQUIRE(write_vtp(mesh, files["vtp"], labels));
  return files;
}

std::size_t point_count(const IndexedMesh& mesh) {
  std::set<std::array<float, 3>> points;
  for (const Eigen::Vector3f& p : mesh.positions) points.insert({p.x(), p.y(), p.z()});
  return points.size();
}

void check_shape(const nlohmann::json& facts, const IndexedMesh& mesh, double digits_mm = 0) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : mesh.positions) box.extend(p);
  CHECK(facts["triangles"] == mesh.triangles.size());
  CHECK(facts["points"] == point_count(mesh));
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(std::abs(facts["low"][k].get<double>() - box.min()[static_cast<Eigen::Index>(k)]) <= digits_mm);
    CHECK(std::abs(facts["high"][k].get<double>() - box.max()[static_cast<Eigen::Index>(k)]) <= digits_mm);
  }
}

/// Triangles by the label whose colour they have: the one behind, else the one in front.
std::map<Label, std::size_t> shown_labels(const IndexedMesh& mesh) {
  std::map<Label, std::size_t> count;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    ++count[mesh.label_back[t] != kOutside ? mesh.label_back[t] : mesh.label_front[t]];
  return count;
}

std::string text_of(const Rgb& colour) {
  return '(' + std::to_string(colour[0]) + ", " + std::to_string(colour[1]) + ", " + std::to_string(colour[2]) + ')';
}

/// A mesh of a file with three labels at some edges.
IndexedMesh reconstructed(const TemporaryFolder& folder) {
  std::filesystem::copy("examples/reconstruct_file/two_balls.csl", folder.path("balls.csl"));
  const ToolRun run = run_tool(folder, "reconstruct balls.csl --depth 6 --device cpu -o balls.ply");
  REQUIRE_MESSAGE(run.status == 0, run.err);
  auto mesh = read_mesh(folder.path("balls.ply"));
  REQUIRE(mesh);
  return std::move(*mesh);
}

}  // namespace

TEST_CASE("formats: VTK reads every format with the same points, triangles and box, left on the left") {
  if (!has_vtk()) return;
  const TemporaryFolder folder;
  const IndexedMesh boxes = twin_boxes().indexed();
  const auto files = write_all(boxes, two_names(), folder);
  for (const auto& entry : files) {
    const auto& file = entry.second;
    CAPTURE(file);
    const auto facts = facts_of(file, folder);
    check_shape(facts, boxes);
    CHECK(facts["low"] == nlohmann::json{0, 0, 0});  // x grows to the left, y to the back, z upwards
    CHECK(facts["high"] == nlohmann::json{3, 2, 3});
  }
  for (const char* ending : {"ply", "obj"}) CHECK(bytes_of(files.at(ending)).find("SPACE=LPS") != std::string::npos);
  CHECK(facts_of(files.at("vtp"), folder)["space"] == "LPS");
}

TEST_CASE("formats: VTK finds the labels: boundaries, names, colours and groups") {
  if (!has_vtk()) return;
  const TemporaryFolder folder;
  const auto files = write_all(twin_boxes().indexed(), two_names(), folder);
  const auto vtp = facts_of(files.at("vtp"), folder);
  MESSAGE(vtp.dump());
  CHECK(vtp["names"] == nlohmann::json{{"2", "left kidney"}, {"5", "spleen"}});
  CHECK(vtp["labels"]["2"]["volume_mm3"].get<double>() == doctest::Approx(6));  // normals from Label0 to Label1
  CHECK(vtp["labels"]["5"]["volume_mm3"].get<double>() == doctest::Approx(12));
  for (const char* label : {"2", "5"}) CHECK(vtp["labels"][label]["triangles"] == 12);
  CHECK(facts_of(files.at("ply"), folder)["colours"] ==
        nlohmann::json{{"(10, 200, 30)", 12}, {"(250, 0, 125)", 10}});  // the wall has one colour
  CHECK(facts_of(files.at("obj"), folder)["groups"] == nlohmann::json{{"front_0_back_2", 4},
                                                                      {"front_0_back_5", 6},
                                                                      {"front_2_back_0", 6},
                                                                      {"front_5_back_0", 4},
                                                                      {"front_5_back_2", 2}});
}

TEST_CASE("formats: a reconstructed mesh comes through every format whole, with all its labels") {
  if (!has_vtk()) return;
  const TemporaryFolder folder;
  const IndexedMesh mesh = reconstructed(folder);
  const auto files = write_all(mesh, {}, folder);
  for (const auto& entry : files) {
    const auto& file = entry.second;
    CAPTURE(file);
    check_shape(facts_of(file, folder), mesh);
  }
  MESSAGE(mesh.positions.size(), " points, ", mesh.triangles.size(), " triangles");
  const auto vtp = facts_of(files.at("vtp"), folder), ply = facts_of(files.at("ply"), folder),
             obj = facts_of(files.at("obj"), folder);
  for (const auto& shown : shown_labels(mesh)) {
    const Label label = shown.first;
    CAPTURE(label);
    CHECK(ply["colours"][text_of(label_colour(label))] == shown.second);
    std::size_t grouped = 0;
    for (const auto& group : obj["groups"].items())
      if (group.key().ends_with("_back_" + std::to_string(label)) ||
          group.key() == "front_" + std::to_string(label) + "_back_0")
        grouped += group.value().get<std::size_t>();
    CHECK(grouped == shown.second);
    const auto bounding = std::count(mesh.label_front.begin(), mesh.label_front.end(), label) +
                          std::count(mesh.label_back.begin(), mesh.label_back.end(), label);
    CHECK(vtp["labels"][std::to_string(label)]["triangles"] == bounding);
    CHECK(vtp["labels"][std::to_string(label)]["volume_mm3"].get<double>() > 0);
  }
  CHECK(vtp["labels"].size() == shown_labels(mesh).size());
}

TEST_CASE("formats: MeshLab reads PLY, STL and OBJ, Assimp OBJ, and what they write again has the same shape") {
  if (!has_vtk()) return;
  const TemporaryFolder folder;
  const IndexedMesh mesh = reconstructed(folder);
  const auto files = write_all(mesh, {}, folder);
  const auto converts = [&](const std::string& program, const std::string& from, const std::string& options) {
    const auto file = folder.path("again.ply");
    std::filesystem::remove(file);
    const std::string log = folder.path("log.txt").string();
    REQUIRE_MESSAGE(can(program + ' ' + from + ' ' + file.string() + options + " >" + log + " 2>&1"), bytes_of(log));
    check_shape(facts_of(file, folder), mesh, 1e-4);  // text with six digits in between
  };
  if (can("command -v meshlabserver >/dev/null && command -v xvfb-run >/dev/null")) {
    for (const char* ending : {"ply", "stl", "obj"})
      converts("xvfb-run -a sh -c 'meshlabserver -i $0 -o $1'", files.at(ending).string(), "");
  } else {
    MESSAGE("SKIP: no meshlabserver: apt install meshlab xvfb xauth libgl1-mesa-dri");
  }
  if (can("command -v assimp >/dev/null")) {
    converts("assimp export", files.at("obj").string(), " -jiv");
  } else {
    MESSAGE("SKIP: no assimp: apt install assimp-utils");
  }
}
