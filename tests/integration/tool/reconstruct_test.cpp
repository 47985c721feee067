#include <doctest/doctest.h>

#include <algorithm>

#include "core/io/meshes/mesh_files.h"
#include "tests/integration/tool/tool_run.h"

using namespace sonoloft;
using namespace sonoloft::test;

TEST_CASE("tool reconstruct: the report has every figure and the mesh is what it says") {
  const TemporaryFolder folder;
  folder.write("boxes.csl", boxes_csl());
  const ToolRun run =
      run_tool(folder, "reconstruct boxes.csl -o m.ply --depth 6 --device cpu --report r.json --picture m.png");
  REQUIRE_MESSAGE(run.status == 0, run.err);
  CHECK(run.err.empty());

  const auto report = json_of(folder.path("r.json"));
  CHECK(report["input"]["planes"] == 14);
  CHECK(report["input"]["vertices"] == 4 * (9 + 5 + 5 + 3));  // the inner box meets 5 and 3 planes
  CHECK(report["input"]["labels"] == 2);
  CHECK(report["slices"] == nlohmann::json{{"inserted", 14}, {"explained", 0}, {"merged", 0}, {"refused", 0}});
  for (const char* key : {"cells", "faces", "edges", "samples", "leaves", "triangles"}) CHECK(report[key] > 0);
  CHECK(report["cells"] == 10 * 6);
  CHECK(report["device"].get<std::string>().starts_with("CPU"));
  for (const char* key : {"load", "device_start", "cells", "field", "octree", "mesh", "smooth", "total"})
    CHECK(report["times_ms"][key] > 0);
  const auto& times = report["times_ms"];
  CHECK(times["total"] > times["cells"].get<double>() + times["field"].get<double>() + times["mesh"].get<double>());
  for (const char* key : {"p50", "p95", "max"}) CHECK(report["per_slice_ms"][key] > 0);

  const std::string ply = bytes_of(folder.path("m.ply"));
  const std::size_t triangles = report["triangles"];
  const auto mesh = read_mesh(folder.path("m.ply"));
  REQUIRE(mesh);
  CHECK(mesh->triangles.size() == triangles);
  const std::string header = "ply\nformat binary_little_endian 1.0\n";
  CHECK(ply.starts_with(header));
  const std::string rest = "element vertex " + std::to_string(mesh->positions.size()) +
                           "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                           std::to_string(triangles) +
                           "\nproperty list uchar int vertex_indices\nproperty ushort label_front\n"
                           "property ushort label_back\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                           "end_header\n";
  const std::size_t at = ply.find(rest);
  REQUIRE(at != std::string::npos);
  CHECK(ply.size() == at + rest.size() + 12 * mesh->positions.size() + 20 * triangles);
  CHECK(ply.find("SPACE=LPS") < at);
  CHECK(bytes_of(folder.path("m.png")).starts_with("\x89PNG"));
}

TEST_CASE("tool reconstruct: slice by slice, and with other numbers of threads, gives the same bytes") {
  const TemporaryFolder folder;
  folder.write("boxes.csl", boxes_csl());
  const std::string options = " --depth 6 --device cpu";
  REQUIRE(run_tool(folder, "reconstruct boxes.csl -o all.ply --threads 1" + options).status == 0);
  REQUIRE(run_tool(folder, "reconstruct boxes.csl -o two.ply --threads 2" + options).status == 0);
  REQUIRE(run_tool(folder, "reconstruct boxes.csl -o online.ply --online --report r.json" + options).status == 0);
  const std::string all = bytes_of(folder.path("all.ply"));
  CHECK(all.size() > 10000);
  CHECK(all == bytes_of(folder.path("two.ply")));
  CHECK(all == bytes_of(folder.path("online.ply")));
  const auto report = json_of(folder.path("r.json"));
  CHECK(report["per_slice_ms"]["max"] > 0);
  CHECK(report["input"]["planes"] == 14);
}

TEST_CASE("tool reconstruct: the suffix chooses the format, missing folders are made") {
  const TemporaryFolder folder;
  folder.write("boxes.csl", boxes_csl());
  for (const char* file : {"a/m.obj", "a/b/m.stl", "m.vtp"}) {
    const ToolRun run = run_tool(folder, std::string("reconstruct boxes.csl --depth 5 --device cpu -o ") + file);
    REQUIRE_MESSAGE(run.status == 0, run.err);
  }
  const auto obj = read_mesh(folder.path("a/m.obj")), stl = read_mesh(folder.path("a/b/m.stl"));
  REQUIRE(obj);
  REQUIRE(stl);
  CHECK(obj->triangles.size() > 100);
  CHECK(obj->triangles.size() == stl->triangles.size());
  CHECK(bytes_of(folder.path("m.vtp")).find("BoundaryLabels") != std::string::npos);
}

TEST_CASE("tool reconstruct: a resolution in mm is the edge of the finest cells") {
  const TemporaryFolder folder;
  folder.write("boxes.csl", boxes_csl());
  const auto triangles = [&](const std::string& mm) {
    REQUIRE(
        run_tool(folder, "reconstruct boxes.csl -o m.ply --device cpu --report r.json --resolution-mm " + mm).status ==
        0);
    return json_of(folder.path("r.json"))["triangles"].get<double>();
  };
  const double coarse = triangles("1"), fine = triangles("0.5");
  MESSAGE(coarse, " triangles at 1 mm, ", fine, " at 0.5 mm");
  CHECK(fine > 3.2 * coarse);
  CHECK(fine < 4.8 * coarse);
}

TEST_CASE("tool reconstruct: --mesher delaunay gives an export mesh of both labels, or says how to get one") {
  const TemporaryFolder folder;
  folder.write("boxes.csl", boxes_csl());
  const ToolRun run = run_tool(
      folder, "reconstruct boxes.csl -o m.ply --mesher delaunay --online --depth 5 --device cpu --report r.json");
#ifdef SONOLOFT_WITH_OFFLINE
  REQUIRE_MESSAGE(run.status == 0, run.err);
  const auto report = json_of(folder.path("r.json"));
  CHECK(report["mesher"] == "delaunay");
  CHECK(report["times_ms"]["delaunay"] > 0);
  const auto mesh = read_mesh(folder.path("m.ply"));
  REQUIRE(mesh);
  CHECK(mesh->triangles.size() == report["triangles"]);
  for (const Label label : {Label{1}, Label{2}}) CHECK(std::ranges::count(mesh->label_back, label) > 100);
#else
  CHECK(run.status == 1);
  CHECK(run.err.find("SONOLOFT_OFFLINE") != std::string::npos);
#endif
}

TEST_CASE("tool reconstruct: --completion published fills what was not seen in another way, by --hops in others") {
  const TemporaryFolder folder;
  folder.write("boxes.csl", boxes_csl() +
                                "CSLX 1 2\nunknown 4 4\n5 5 0\n15 5 0\n15 15 0\n5 15 0\n"  // of two planes that cross
                                "unknown 13 4\n8.5 5 -5\n8.5 15 -5\n8.5 15 5\n8.5 5 5\n");
  const auto mesh = [&](const std::string& options) {
    const ToolRun run = run_tool(folder, "reconstruct boxes.csl -o m.ply --depth 6 --device cpu " + options);
    REQUIRE_MESSAGE(run.status == 0, run.err);
    return bytes_of(folder.path("m.ply"));
  };
  const std::string published = mesh("--completion published");
  CHECK(published != mesh(""));
  CHECK(published != mesh("--completion published --hops 1"));
  CHECK(mesh("") == mesh("--completion background"));
  CHECK(run_tool(folder, "reconstruct boxes.csl -o m.ply --hops 1").status == 2);
  CHECK(run_tool(folder, "reconstruct boxes.csl -o m.ply --completion guess").status == 2);
}
