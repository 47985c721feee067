#pragma once
#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "host/apps/tool/phantom/simulated_scan.h"

namespace sonoloft::tool {

/// What a simulated probe scans, and how.
struct SimulatedProbeOptions {
  std::string phantom = "liver";
  ScanPlan plan;
  std::optional<std::filesystem::path> data;
};

/// --phantom, --slices, --rate, --seed, --data
void add_simulated_probe(CLI::App& verb, SimulatedProbeOptions& options);

}  // namespace sonoloft::tool
