#include "tests/bench/accuracy/cases.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <utility>

#include "core/io/meshes/mesh_files.h"
#include "core/io/volumes/volume_files.h"
#include "device_sim/probe/phantoms/mesh_phantom.h"
#include "device_sim/probe/phantoms/volume_phantom.h"
#include "tests/bench/support/reconstruction.h"
#include "tests/support/bodies/bodies.h"
#include "tests/support/bodies/cut.h"
#include "tests/support/bodies/plane_sets.h"
#include "tests/support/bodies/true_surface.h"

namespace sonoloft::bench {
namespace {

constexpr double kNoises[] = {0, 0.25, 0.5, 1};  // %
constexpr std::uint64_t kSeeds = 3;              // of the planes through a mesh: one set of them says little
const std::map<std::string, const char*> kTruthOfRecorded = {
    {"eight_15", "eight_20_scaled"}, {"eight_20", "eight_20_scaled"}, {"hand_ok", "hand_ok_scaled"}};
const char* const kMeshes[] = {"armadillo", "bull", "camel", "elephant", "femur", "knot2", "retinal"};
const char* const kSweptMeshes[] = {"camel", "femur"};

std::optional<std::filesystem::path> present(const std::filesystem::path& file, const char* remedy) {
  if (std::filesystem::exists(file)) return file;
  std::fprintf(stderr, "SKIP: %s is absent%s\n", file.c_str(), remedy);
  return std::nullopt;
}

std::optional<Case> recorded(const std::string& set) {
  const std::filesystem::path folder = "../shared/data";
  const auto slices = present(folder / "csl" / (set + ".csl"), "");
  const auto truth = present(folder / "truth" / (kTruthOfRecorded.at(set) + std::string(".stl")), "");
  if (!slices || !truth) return std::nullopt;
  return Case{read_set(*slices), or_exit(read_mesh(*truth)), nullptr};
}

std::vector<TrackedSlice> sliced(const NamedCase& c, const device_sim::SectionSource& body,
                                 const IndexedMesh& surface) {
  const auto kind = std::find_if(std::begin(test::kPlaneSets), std::end(test::kPlaneSets),
                                 [&](const test::NamedPlaneSet& named) { return named.name == c.planes; });
  return test::cut(body, test::make_planes(kind->set, c.count, surface.positions, c.seed));
}

std::filesystem::path data_folder() {
  const char* variable = std::getenv("SONOLOFT_DATA");
  return variable ? variable : "build/data";
}

std::optional<Case> mesh(const NamedCase& c) {
  const auto file = present(data_folder() / (c.set + ".off"), ": unpack the meshes of Debian's libcgal-demo there");
  if (!file) return std::nullopt;
  IndexedMesh truth = or_exit(read_mesh(*file));
  std::vector<Eigen::Vector3d> positions;
  for (const Eigen::Vector3f& p : truth.positions) positions.push_back(p.cast<double>());
  const auto body = device_sim::MeshPhantom::make(std::move(positions), truth.triangles, 1);
  if (!body.value) stop({ErrorCode::invalid_argument, file->string() + ": " + body.error});
  auto slices = sliced(c, *body.value, truth);
  return Case{std::move(slices), std::move(truth), nullptr};
}

std::optional<Case> body(const NamedCase& c) {
  std::vector<test::NamedBody> bodies = test::bodies_of_one_label();
  bodies.push_back(test::body_of_three_labels());
  const auto named =
      std::find_if(bodies.begin(), bodies.end(), [&](const test::NamedBody& b) { return b.name == c.set; });
  static std::map<std::string, IndexedMesh> surfaces;  // drawn once
  if (!surfaces.contains(c.set)) surfaces[c.set] = test::true_surface(*named->body);
  return Case{sliced(c, *named->body, surfaces[c.set]), surfaces[c.set], named->body};
}

/// The liver of the demo, with its vessels and its tumour.
std::optional<Case> liver(const NamedCase& c) {
  const auto file = present(data_folder() / "liver.inr.gz", ": unpack it from Debian's libcgal-demo there");
  if (!file) return std::nullopt;
  LabelVolume volume = or_exit(read_inr(*file));
  const std::map<Label, Label> labels = {{255, 1}, {127, 2}, {85, 3}};  // the rest are stray voxels
  for (Label& label : volume.labels) label = labels.contains(label) ? labels.at(label) : kOutside;
  const auto& [x, y, z] = volume.dims;
  auto made = device_sim::VolumePhantom::make(Eigen::Matrix<std::uint32_t, 3, 1>(x, y, z).cast<int>(),
                                              volume.spacing_mm, volume.origin_mm, volume.labels);
  if (!made.value) stop({ErrorCode::invalid_argument, file->string() + ": " + made.error});
  const std::shared_ptr<const device_sim::Phantom> body = std::move(made.value);
  IndexedMesh surface = test::true_surface(*body);
  auto slices = sliced(c, *body, surface);
  return Case{std::move(slices), std::move(surface), body};
}

double diagonal_mm(const Case& c) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& p : c.surface.positions) box.extend(p.cast<double>());
  return box.diagonal().norm();
}

}  // namespace

std::string NamedCase::name() const {
  char name[200];
  if (count == 0)
    std::snprintf(name, sizeof name, "%s/%s/%s/noise %g", group.c_str(), set.c_str(), planes.c_str(), noise);
  else
    std::snprintf(name, sizeof name, "%s/%s/%zu %s %zu/noise %g", group.c_str(), set.c_str(), count, planes.c_str(),
                  std::size_t{seed}, noise);
  return name;
}

std::optional<Case> NamedCase::make() const {
  std::optional<Case> c = group == "recorded" ? recorded(set)
                          : group == "meshes" ? mesh(*this)
                          : group == "images" ? liver(*this)
                                              : body(*this);
  if (c && noise > 0) c->slices = test::with_noise(std::move(c->slices), 0.01 * noise * diagonal_mm(*c), seed);
  return c;
}

std::vector<NamedCase> all_cases() {
  std::vector<NamedCase> cases;
  for (const double noise : kNoises) {
    for (const auto& [set, truth] : kTruthOfRecorded) cases.push_back({"recorded", set, "as recorded", 0, noise, 1});
    for (const char* set : kMeshes)
      for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) cases.push_back({"meshes", set, "random", 20, noise, seed});
  }
  for (const char* set : kSweptMeshes)
    for (const std::size_t count : {10u, 40u})
      for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) cases.push_back({"meshes", set, "random", count, 0, seed});
  for (const char* planes : {"random", "freehand"}) cases.push_back({"images", "liver", planes, 20, 0, 1});
  for (const test::NamedBody& named : test::bodies_of_one_label())
    for (const test::NamedPlaneSet& planes : test::kPlaneSets)
      cases.push_back({"bodies", named.name, planes.name, 20, 0, 1});
  for (const test::NamedBody& named : test::bodies_of_one_label())
    for (const std::size_t count : {10u, 40u}) cases.push_back({"bodies", named.name, "random", count, 0, 1});
  const std::string three = test::body_of_three_labels().name;
  for (const std::size_t count : {12u, 24u, 40u}) cases.push_back({"junctions", three, "random", count, 0, 1});
  for (const std::size_t count : {8u, 14u}) cases.push_back({"junctions", three, "stack", count, 0, 1});
  cases.push_back({"junctions", three, "random", 24, 0.5, 1});
  cases.push_back({"junctions", three, "stack", 14, 0.5, 1});
  return cases;
}

}  // namespace sonoloft::bench
