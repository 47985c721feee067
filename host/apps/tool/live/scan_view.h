#pragma once
// ScanSession -> [SCAN VIEW] -> ViewServer -> browser
#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/io/labels/label_table.h"
#include "core/slice/result.h"
#include "host/apps/tool/live/scan_recorder.h"
#include "host/scan/scan_session.h"
#include "host/view/view_server.h"

namespace sonoloft::tool {

struct ViewChoice {
  bool view = false;
  view::ViewOptions options;
};

/// --view, --view-port, --view-address
void add_view(CLI::App& verb, ViewChoice& choice);
/// --view-port, --view-address
void add_view_place(CLI::App& verb, view::ViewOptions& options);

/// Serves the page and says where it is. @error those of ViewServer::open()
[[nodiscard]] Result<std::unique_ptr<view::ViewServer>> open_view(const view::ViewOptions& options,
                                                                  view::ViewSource source);
/// Until Ctrl-C. @pre note_interrupts() was called
void wait_for_interrupt();

/// A scan on the page; without --view nothing.
class ScanView {
 public:
  /// @param recorder  records what a page asks for; null: pages do not offer it
  /// @pre the scan outlives the view @error those of ViewServer::open()
  [[nodiscard]] static Result<ScanView> open(const ViewChoice& choice, const ScanSession& scan,
                                             const LabelTable& labels, std::unique_ptr<ScanRecorder> recorder = {});

  /// The same callbacks, which show on the page besides what they get, as long as there is the view.
  [[nodiscard]] ScanCallbacks shown(ScanCallbacks callbacks) const;
  /// Somebody has pressed "Stop" on the page.
  [[nodiscard]] bool stopped() const { return *stopped_; }
  /// The scan is over, and what was recorded is in its files: the page stays until Ctrl-C.
  void linger() const;

 private:
  std::shared_ptr<std::atomic<bool>> stopped_ = std::make_shared<std::atomic<bool>>(false);
  std::unique_ptr<ScanRecorder> recorder_;  ///< the server calls it
  std::shared_ptr<view::ViewServer> server_;
};

}  // namespace sonoloft::tool
