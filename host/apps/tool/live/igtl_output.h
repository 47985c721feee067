#pragma once
// ScanSession -> [IGTL OUTPUT] -> igtl::Server -> 3D Slicer and other programs
#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include "core/io/labels/label_table.h"
#include "core/slice/result.h"
#include "host/scan/scan_session.h"

namespace sonoloft::tool {

struct IgtlChoice {
  std::optional<std::uint16_t> port;  ///< empty: nothing is served
  std::string address = "127.0.0.1";
};

/// --igtl, --igtl-address
void add_igtl(CLI::App& verb, IgtlChoice& choice);

/// A scan for OpenIGTLink clients; without --igtl nothing.
class IgtlOutput {
 public:
  /// Says where it is. @error those of igtl::Server::start(), not_available (built without OpenIGTLink)
  [[nodiscard]] static Result<IgtlOutput> open(const IgtlChoice& choice, const LabelTable& labels);

  /// The same callbacks, which show to clients besides what they get.
  [[nodiscard]] ScanCallbacks shown(ScanCallbacks callbacks) const;

 private:
  ScanCallbacks clients_;  ///< empty ones where nothing is served
};

}  // namespace sonoloft::tool
