#include "host/apps/tool/phantom/simulated_probe_options.h"

#include "host/apps/tool/common_options.h"

namespace sonoloft::tool {

void add_simulated_probe(CLI::App& verb, SimulatedProbeOptions& options) {
  verb.add_option(
          "--phantom", options.phantom,
          "liver, femur, organs, torso (ribs that shadow), or a file: recorded slices (.csl, .contour), a closed "
          "mesh (.off, .stl, .ply, .obj), voxels (.inr, .inr.gz)")
      ->capture_default_str();
  verb.add_option("--slices", options.plan.slices,
                  "Slices of the sweep; default: 60, of the torso 300, or all that were recorded")
      ->check(CLI::Range(1, 100000));
  verb.add_option("--rate", options.plan.rate_hz, "Slices a second; 0: as fast as they are used")
      ->check(finite(0, 1000))
      ->capture_default_str();
  verb.add_flag("--masks", options.plan.masks,
                "It sends a label for every pixel instead of contours, as a segmenting network does");
  verb.add_option("--seed", options.plan.seed, "Of the hand that holds the probe, and of noise")
      ->check(finite(0, 1e15))
      ->capture_default_str();
  verb.add_option("--data", options.data, "Folder of the demo's data; default: $SONOLOFT_DATA, then build/data");
}

}  // namespace sonoloft::tool
