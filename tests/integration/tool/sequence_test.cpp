#include <doctest/doctest.h>

#include <cmath>

#include "core/io/meshes/mesh_files.h"
#include "tests/integration/tool/tool_run.h"
#include "tests/support/mesh/mesh_check.h"
#include "tests/support/sequence_file.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

constexpr int kImages = 25, kSize = 64;
const char* const kConfig =
    "<PlusConfiguration><CoordinateDefinitions><Transform From=\"Image\" To=\"Probe\" "
    "Matrix=\"0.5 0 0 -16 0 0.5 0 -16 0 0 0.5 0 0 0 0 1\"/></CoordinateDefinitions></PlusConfiguration>";

/// A ball of 10 mm around (0.25, 0.25, 0) mm in images a millimetre apart; label 3, and 4 where its z is above 0.
std::string pixels() {
  std::string bytes;
  for (int i = 0; i < kImages; ++i)
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const double z = i - 12, r = std::hypot(0.5 * x - 16.25, 0.5 * y - 16.25, z);
        bytes += static_cast<char>(r > 10 ? 0 : z > 0 ? 4 : 3);
      }
  return bytes;
}

/// The probe goes along z of a reference that is at (100, 0, 0) in the tracker.
Fields poses() {
  Fields fields;
  for (int i = 0; i < kImages; ++i) {
    const std::string time = std::to_string(0.1 * i);
    const std::string probe = "1 0 0 100 0 1 0 0 0 0 1 " + std::to_string(i - 12) + " 0 0 0 1";
    for (const auto& field : frame_fields(i, probe, time, i == 3 ? "MISSING" : "OK")) fields.push_back(field);
    const Fields reference = frame_fields(i, "1 0 0 100 0 1 0 0 0 0 1 0 0 0 0 1", time, "OK", "ReferenceToTracker");
    fields.insert(fields.end(), reference.begin(), reference.begin() + 2);
  }
  return fields;
}

}  // namespace

TEST_CASE("tool reconstruct: tracked label images of PLUS, of both formats, become the body that they were cut from") {
  const TemporaryFolder folder;
  folder.write("plus.xml", kConfig);
  folder.write("ball.igs.mha", meta_image("64 64 25", poses(), pixels()));
  folder.write("ball.igs.nrrd", nrrd("64 64 25", poses(), pixels()));
  const std::string options = " --config plus.xml --device cpu --resolution-mm 0.5 --report r.json -o ";
  const ToolRun run = run_tool(folder, "reconstruct ball.igs.mha" + options + "m.ply");
  REQUIRE_MESSAGE(run.status == 0, run.err);
  const auto report = json_of(folder.path("r.json"));
  CHECK(report["input"]["frames"] ==
        nlohmann::json{{"in_file", 25}, {"pixels", "labels"}, {"without_image", 0}, {"without_pose", 1}});
  CHECK(report["input"]["labels"] == 2);
  CHECK(report["slices"]["refused"] == 0);

  const auto mesh = read_mesh(folder.path("m.ply"));
  REQUIRE(mesh);
  const MeshReport truth = check_mesh(*mesh);
  CHECK(truth.closed_manifold());
  const double volumes = truth.labels.at(3).volume_mm3 + truth.labels.at(4).volume_mm3;
  MESSAGE("ball of ", volumes, " mm3, of 4189");
  CHECK(volumes == doctest::Approx(4189).epsilon(0.02));
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : mesh->positions) box.extend(p);
  CHECK((box.center() - Eigen::Vector3f(0.25f, 0.25f, 0)).norm() < 0.4);
  for (std::size_t t = 0; t < mesh->triangles.size(); ++t)
    if (mesh->label_back[t] == 4 || mesh->label_front[t] == 4) CHECK(mesh->positions[mesh->triangles[t][0]].z() > 0);

  REQUIRE(run_tool(folder, "reconstruct ball.igs.nrrd" + options + "n.ply").status == 0);
  CHECK(bytes_of(folder.path("n.ply")) == bytes_of(folder.path("m.ply")));
}

TEST_CASE("tool reconstruct: what a sequence lacks is named") {
  const TemporaryFolder folder;
  folder.write("plus.xml", kConfig);
  folder.write("ball.igs.mha", meta_image("64 64 25", poses(), pixels()));
  const ToolRun alone = run_tool(folder, "reconstruct ball.igs.mha -o m.ply");
  CHECK(alone.status == 1);
  CHECK(alone.err.find("from Image to Reference: joined are {Image} and {Reference, Tracker, Probe}") !=
        std::string::npos);
  const ToolRun elsewhere = run_tool(folder, "reconstruct ball.igs.mha --config plus.xml --reference Bed -o m.ply");
  CHECK(elsewhere.err.find("{Bed}") != std::string::npos);
  const ToolRun dark = run_tool(folder, "reconstruct ball.igs.mha --config ball.igs.mha -o m.ply");
  CHECK(dark.err.find("no XML") != std::string::npos);
  CHECK(run_tool(folder, "reconstruct ball.igs.mha --pixels guess -o m.ply").status == 2);
  CHECK(run_tool(folder, "reconstruct ball.igs.mha --unknown-value 256 -o m.ply").status == 2);
}

TEST_CASE("tool: --labels gives meshes, volumes and reports their names") {
  const TemporaryFolder folder;
  folder.write("boxes.csl", boxes_csl());
  folder.write("boxes.ctbl", "# Color table file\n0 Background 0 0 0 0\n1 the_box 10 200 30 255\n");
  for (const char* file : {"m.ply", "m.obj", "m.seg.nrrd"}) {
    const ToolRun run = run_tool(folder, std::string("reconstruct boxes.csl --depth 5 --device cpu --labels boxes.ctbl "
                                                     "--report r.json -o ") +
                                             file);
    REQUIRE_MESSAGE(run.status == 0, run.err);
  }
  CHECK(bytes_of(folder.path("m.ply")).find("comment label 1 10 200 30 the box\n") != std::string::npos);
  CHECK(bytes_of(folder.path("m.mtl")).find("newmtl the_box\n") != std::string::npos);
  CHECK(bytes_of(folder.path("m.seg.nrrd")).find("Segment0_Name:=the box\n") != std::string::npos);
  const auto labels = json_of(folder.path("r.json"))["labels"];
  CHECK(labels["1"]["name"] == "the box");
  CHECK(labels["2"]["name"] == "label 2");
  CHECK(labels["2"]["triangles"] > 100);

  folder.write("bad.ctbl", "# Color table file\n1 box 10 200\n");
  for (const char* verb :
       {"reconstruct boxes.csl -o m.ply", "demo --phantom organs", "scan --simulated -o m.ply", "replay no.mcap"}) {
    const ToolRun bad = run_tool(folder, verb + std::string(" --labels bad.ctbl"));
    CHECK(bad.status == 1);
    CHECK(bad.err.find("bad.ctbl:2: ") != std::string::npos);
  }
}
