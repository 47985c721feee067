#pragma once
// options -> [PROBE SOURCE] -> transport
#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "core/slice/result.h"
#include "host/apps/tool/phantom/simulated_probe_options.h"
#include "host/device/transport.h"

namespace sonoloft::tool {

/// Which probe a verb uses.
struct ProbeSource {
  std::string serial;
  bool simulated = false;
  SimulatedProbeOptions probe;
};

/// --serial, --simulated and what belongs to it
void add_probe_source(CLI::App& verb, ProbeSource& source);

struct OpenedProbe {
  std::unique_ptr<SimulatedScan> simulated;  ///< outlives the transport
  std::unique_ptr<device::Transport> transport;
};

/// Says which probe it is. @error those of UsbTransport::open(), load_body() and SimulatedScan::make()
[[nodiscard]] Result<OpenedProbe> open_probe(const ProbeSource& source);

}  // namespace sonoloft::tool
