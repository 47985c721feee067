#pragma once
// names -> [CASES] -> slices and what they were cut from
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/slice/tracked_slice.h"
#include "device_sim/probe/phantom.h"

namespace sonoloft::bench {

struct Case {
  std::vector<TrackedSlice> slices;
  IndexedMesh surface;                              ///< of the truth
  std::shared_ptr<const device_sim::Phantom> body;  ///< where the truth is a formula
};

/// A case that can be made. The name is group/set/count planes seed/noise.
struct NamedCase {
  std::string group;  ///< recorded, meshes, images, bodies, junctions
  std::string set;
  std::string planes;  ///< what kind
  std::size_t count;   ///< of planes; 0: as recorded
  double noise;        ///< of vertices, standard deviation along each axis in the plane, % of the truth's diagonal
  std::uint64_t seed;  ///< of the planes and the noise
  [[nodiscard]] std::string name() const;
  /// Nothing where its data are absent; says so. Ends the program where they make no sense.
  [[nodiscard]] std::optional<Case> make() const;
};

/// All there are: recorded stacks with their truth, Debian's meshes and its liver of libcgal-demo, bodies of one
/// label by formulas, the body of three labels.
[[nodiscard]] std::vector<NamedCase> all_cases();

}  // namespace sonoloft::bench
