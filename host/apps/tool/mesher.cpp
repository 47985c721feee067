#include "host/apps/tool/mesher.h"

#ifdef SONOLOFT_WITH_OFFLINE
#include "core/offline/delaunay_mesher.h"
#endif

namespace sonoloft::tool {
namespace {

#ifdef SONOLOFT_WITH_OFFLINE
constexpr const char* kPresence = "built in, which puts this program as a whole under the GPL";

Result<IndexedMesh> delaunay_surfaces(const Reconstructor& reconstructor, double& ms) {
  const SampleLattice& samples = reconstructor.samples();
  auto refined = delaunay_mesh(samples, reconstructor.mesh(), DelaunayCriteria::like_live(samples.spacing_mm()));
  if (!refined) return tl::unexpected<Error>(refined.error());
  ms = refined->ms;
  return std::move(refined->mesh);
}
#else
constexpr const char* kPresence = "not built in";

Result<IndexedMesh> delaunay_surfaces(const Reconstructor&, double&) {
  return fail(ErrorCode::not_available,
              "--mesher delaunay is not built in: install CGAL's Mesh_3 (Debian: libcgal-dev) and build with "
              "-DSONOLOFT_OFFLINE=ON");
}
#endif

}  // namespace

void add_mesher(CLI::App& verb, Mesher& mesher) {
  verb.add_option_function<std::string>(
          "--mesher", [&mesher](const std::string& name) { mesher = name == "live" ? Mesher::live : Mesher::delaunay; },
          std::string("How the mesh is drawn: live (as in a scan, at once), delaunay (no angle below 30 degrees, takes "
                      "seconds to minutes; ") +
              kPresence + ")")
      ->check(CLI::IsMember({"live", "delaunay"}))
      ->default_str("live");
}

Result<IndexedMesh> surfaces(const Reconstructor& reconstructor, Mesher mesher, double& delaunay_ms) {
  if (mesher == Mesher::delaunay) return delaunay_surfaces(reconstructor, delaunay_ms);
  return reconstructor.mesh().indexed();
}

}  // namespace sonoloft::tool
