#pragma once
// What verbs that scan have in common:  transport -> ScanSession -> [LIVE SCAN] -> last mesh
#include <CLI/CLI.hpp>
#include <array>
#include <functional>
#include <memory>

#include "core/slice/result.h"
#include "host/apps/tool/common_options.h"
#include "host/apps/tool/live/igtl_output.h"
#include "host/apps/tool/live/scan_view.h"
#include "host/scan/scan_session.h"

namespace sonoloft::tool {

/// Where a scan takes place, how finely, and what computes it.
struct ScanSpace {
  std::array<double, 6> box{-200, -200, -200, 200, 200, 200};
  double spacing_mm = 2;
  Compute compute;
};

/// --box, --resolution-mm, --threads, --device
void add_scan_space(CLI::App& verb, ScanSpace& space);

/// @error invalid_argument (a box without an inside)
[[nodiscard]] Result<ScanOptions> scan_options(const ScanSpace& space, device::StreamMode mode);

/// Until the data end, Ctrl-C or a stop from the page, telling on stdout how it goes; after an end as long as `more`
/// says that data follow. A probe that was unplugged is waited for, and the scan goes on with it.
/// @return the last mesh
/// @error empty_input (no slice came, or they bound nothing), opencl_failed, those of ScanSession::start()
[[nodiscard]] Result<IndexedMesh> scan_all(ScanSession& scan, const ScanView& view, const IgtlOutput& igtl,
                                           const std::function<bool()>& more);

}  // namespace sonoloft::tool
