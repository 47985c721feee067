// For 3D Slicer: a model of each label, in its convention (LPS, mm).
#include <cstdio>
#include <filesystem>
#include <semaphore>
#include <set>

#include "core/io/meshes/mesh_files.h"
#include "host/scan/scan_session.h"
#include "host/simulated/simulated_probe.h"

using namespace sonoloft;

namespace {

/// The surface of one label, wound outwards, with the vertices that it uses.
IndexedMesh surface_of(const IndexedMesh& all, Label label) {
  IndexedMesh one;
  std::vector<std::uint32_t> number(all.positions.size(), ~0u);
  for (std::size_t t = 0; t < all.triangles.size(); ++t) {
    const bool behind = all.label_back[t] == label;
    if (!behind && all.label_front[t] != label) continue;
    auto corners = all.triangles[t];
    if (!behind) std::swap(corners[1], corners[2]);
    for (std::uint32_t& corner : corners) {
      if (number[corner] == ~0u) {
        number[corner] = static_cast<std::uint32_t>(one.positions.size());
        one.positions.push_back(all.positions[corner]);
      }
      corner = number[corner];
    }
    one.triangles.push_back(corners);
    one.label_front.push_back(behind ? all.label_front[t] : all.label_back[t]);
    one.label_back.push_back(label);
  }
  return one;
}

Result<IndexedMesh> scan_all(std::unique_ptr<device::Transport> probe) {
  ScanOptions options;
  options.reconstructor.box = {Eigen::Vector3d::Constant(-300), Eigen::Vector3d::Constant(300)};
  options.reconstructor.spacing_mm = 4;
  options.stream.mode = device::StreamMode::lossless;
  const auto scan = ScanSession::open(std::move(probe), options);
  if (!scan) return tl::unexpected<Error>(scan.error());
  std::counting_semaphore<> end(0);
  std::shared_ptr<const MeshUpdate> last;
  ScanCallbacks callbacks;
  callbacks.on_mesh = [&last](std::shared_ptr<const MeshUpdate> update) { last = std::move(update); };
  callbacks.on_event = [&end](const ScanEvent& event) {
    std::printf("%s\n", event.message.c_str());
    if (ends_run(event.kind)) end.release();
  };
  if (auto started = (*scan)->start(callbacks); !started) return tl::unexpected<Error>(started.error());
  end.acquire();
  (*scan)->stop();
  if (!last) return fail(ErrorCode::empty_input, "no slice came");
  return last->mesh.indexed();
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path folder = argc > 1 ? argv[1] : ".";
  auto probe = open_simulated_probe({.slices = 40, .rate_hz = 0});
  if (!probe) return std::fprintf(stderr, "%s\n", probe.error().message.c_str()), 1;
  const auto mesh = scan_all(std::move(*probe));
  if (!mesh) return std::fprintf(stderr, "%s\n", mesh.error().message.c_str()), 1;
  std::set<Label> labels(mesh->label_front.begin(), mesh->label_front.end());
  labels.insert(mesh->label_back.begin(), mesh->label_back.end());
  labels.erase(kOutside);
  for (const Label label : labels) {
    const auto path = folder / ("label_" + std::to_string(label) + ".vtp");
    const IndexedMesh model = surface_of(*mesh, label);
    if (auto written = write_vtp(model, path); !written)
      return std::fprintf(stderr, "%s\n", written.error().message.c_str()), 1;
    std::printf("%s: %zu triangles\n", path.filename().c_str(), model.triangles.size());
  }
}
