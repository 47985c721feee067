// Label volumes as other programs read them.
#include <cmath>
#include <filesystem>
#include <sstream>
#include <utility>

#include "core/io/meshes/mesh_files.h"
#include "tests/integration/tool/tool_run.h"
#include "tests/support/mesh/mesh_check.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

/// Corners, mm.
struct Box {
  double low[3], high[3];
};
constexpr Box kOrgan{{-20, -14, -12}, {20, 14, 12}};
constexpr Box kLesion{{5, -11, 1}, {17, -2, 9}};  // in LPS: on the left, in front, above

void add_rectangle(std::ostream& out, const Box& box, double z) {
  for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
    out << (x == 0 ? box.low : box.high)[0] << ' ' << (y == 0 ? box.low : box.high)[1] << ' ' << z << '\n';
}

/// 23 slices across z; the lesion is label 2.
std::string lesion_csl() {
  std::ostringstream out;
  out << "CSLC\n23 2\n";
  for (int i = 0; i < 23; ++i) {
    const double z = i - 11;
    const bool lesion = z > kLesion.low[2] && z < kLesion.high[2];
    out << i + 1 << (lesion ? " 8 2" : " 4 1") << " 0 0 1 " << -z << '\n';
    add_rectangle(out, kOrgan, z);
    if (lesion) add_rectangle(out, kLesion, z);
    out << "4 1 0 1 2 3\n" << (lesion ? "4 2 4 5 6 7\n" : "");
  }
  return out.str();
}

bool can(const std::string& command) {
  return std::system(command.c_str()) == 0;
}

nlohmann::json facts_of(const TemporaryFolder& folder, const std::string& file) {
  std::ostringstream command;
  command << "cd " << folder.path("") << " && python3 -B "
          << std::filesystem::absolute("tests/integration/tool/volume_facts.py") << ' ' << file
          << " >facts.json 2>stderr.txt";
  REQUIRE_MESSAGE(can(command.str()), bytes_of(folder.path("stderr.txt")));
  return json_of(folder.path("facts.json"));
}

}  // namespace

TEST_CASE("tool volumes: other programs find each label where the mesh has it, left on the left, and as large") {
  if (!can("python3 -c 'import nibabel' 2>/dev/null && command -v teem-unu >/dev/null")) {
    MESSAGE("SKIP: no nibabel in python3, or no teem-unu: apt install python3-nibabel teem-apps");
    return;
  }
  const TemporaryFolder folder;
  folder.write("lesion.csl", lesion_csl());
  for (const char* file : {"m.ply", "v.seg.nrrd", "a/v.nii", "v.nii.gz"}) {
    const std::string voxels = std::string(file) == "m.ply" ? "" : " --voxel-mm 0.25";
    const ToolRun run = run_tool(folder, "reconstruct lesion.csl --depth 6 --device cpu -o " + (file + voxels));
    REQUIRE_MESSAGE(run.status == 0, run.err);
  }
  const auto mesh = read_mesh(folder.path("m.ply"));
  REQUIRE(mesh);
  const MeshReport exact = check_mesh(*mesh);
  const auto facts = facts_of(folder, "v.seg.nrrd");
  MESSAGE(facts.dump());
  CHECK(facts == facts_of(folder, "a/v.nii"));
  CHECK(facts == facts_of(folder, "v.nii.gz"));
  REQUIRE(facts.size() == 2);
  for (const auto& item : facts.items()) {
    const double ml = exact.labels.at(static_cast<Label>(std::stoi(item.key()))).volume_mm3 / 1000;
    CAPTURE(item.key());
    CAPTURE(ml);
    CHECK(std::abs(item.value()["ml"].get<double>() / ml - 1) < 0.01);
  }
  for (const std::size_t axis : {0u, 1u, 2u}) {
    const double middle = 0.5 * (kLesion.low[axis] + kLesion.high[axis]);
    CHECK(std::abs(facts["2"]["centre"][axis].get<double>() - middle) < 0.3);
  }
}

TEST_CASE("tool volumes: voxels are as large as the finest cells where nothing else is said") {
  const TemporaryFolder folder;
  folder.write("lesion.csl", lesion_csl());
  REQUIRE(run_tool(folder, "reconstruct lesion.csl --resolution-mm 0.8 --device cpu -o v.seg.nrrd").status == 0);
  CHECK(bytes_of(folder.path("v.seg.nrrd")).find("space directions: (0.8,0,0) (0,0.8,0) (0,0,0.8)") !=
        std::string::npos);
  const ToolRun scan = run_tool(folder,
                                "scan --simulated --phantom organs --slices 20 --rate 0 --lossless --resolution-mm 5 "
                                "--device cpu -o v.nii.gz");
  REQUIRE_MESSAGE(scan.status == 0, scan.err);
  CHECK(bytes_of(folder.path("v.nii.gz")).starts_with("\x1f\x8b"));
}

TEST_CASE("tool volumes: a size of voxels needs a label volume, and one that fits; else the mesh is kept") {
  const TemporaryFolder folder;
  folder.write("lesion.csl", lesion_csl());
  const ToolRun mesh = run_tool(folder, "reconstruct lesion.csl -o m.ply --voxel-mm 1");
  CHECK(mesh.status == 2);
  CHECK(mesh.err.find("--voxel-mm") != std::string::npos);
  CHECK(run_tool(folder, "reconstruct lesion.csl -o m.nrrd").status == 2);
  CHECK(run_tool(folder, "scan -o v.nii --voxel-mm 0").status == 2);
  const ToolRun large = run_tool(folder, "reconstruct lesion.csl --depth 5 --device cpu -o v.nii --voxel-mm 0.001");
  CHECK(large.status == 1);
  CHECK(large.err.find("larger") != std::string::npos);
  CHECK(large.err.find("v.nii.ply") != std::string::npos);
  CHECK(read_mesh(folder.path("v.nii.ply")));
}
