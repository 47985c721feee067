#include "host/apps/tool/live/scan_view.h"

#include <chrono>
#include <iostream>
#include <thread>
#include <utility>

#include "host/apps/tool/interrupt.h"

namespace sonoloft::tool {

void add_view(CLI::App& verb, ViewChoice& choice) {
  auto* view = verb.add_flag("--view", choice.view, "Show it live on a page for the browser, until Ctrl-C");
  add_view_place(verb, choice.options);
  for (const char* place : {"--view-port", "--view-address"}) verb.get_option(place)->needs(view);
}

void add_view_place(CLI::App& verb, view::ViewOptions& options) {
  verb.add_option("--view-port", options.port, "Port of the page; 0: any free one; default: 8480, if it is free")
      ->check(CLI::Range(0, 65535));
  verb.add_option("--view-address", options.address,
                  "Address of this machine to serve the page at; beyond this machine it takes the printed token")
      ->capture_default_str();
}

Result<std::unique_ptr<view::ViewServer>> open_view(const view::ViewOptions& options, view::ViewSource source) {
  auto server = view::ViewServer::open(options, std::move(source));
  if (server) std::cout << "view: " << (*server)->url() << std::endl;
  return server;
}

void wait_for_interrupt() {
  std::cout << "view: Ctrl-C ends it" << std::endl;
  while (!interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(100));
}

Result<ScanView> ScanView::open(const ViewChoice& choice, const ScanSession& scan, const LabelTable& labels,
                                std::unique_ptr<ScanRecorder> recorder) {
  ScanView view;
  if (!choice.view) return view;
  view::ViewSource source{labels,
                          [&scan](auto points) { return scan.confidence(points); },
                          [&scan] { return scan.coverage(); },
                          [&scan] { return scan.ledger(); },
                          [stopped = view.stopped_] { *stopped = true; },
                          {}};
  if (recorder) source.record = [recorder = recorder.get()](bool recording) { recorder->ask(recording); };
  auto server = open_view(choice.options, std::move(source));
  if (!server) return tl::unexpected<Error>(server.error());
  view.server_ = std::move(*server);
  view.recorder_ = std::move(recorder);
  if (view.recorder_) view.recorder_->show_on(view.server_);
  view.server_->show("waiting for the probe");
  return view;
}

ScanCallbacks ScanView::shown(ScanCallbacks callbacks) const {
  if (!server_) return callbacks;
  const std::weak_ptr server = server_;
  const auto show = [server](auto&&... thing) {
    if (const auto alive = server.lock()) alive->show(std::forward<decltype(thing)>(thing)...);
  };
  ScanCallbacks both;
  both.on_mesh = [show, then = std::move(callbacks.on_mesh)](std::shared_ptr<const MeshUpdate> update) {
    show(update);
    if (then) then(std::move(update));
  };
  both.on_slice = [show, then = std::move(callbacks.on_slice)](std::shared_ptr<const device::DeliveredSlice> slice) {
    show(slice);
    if (then) then(std::move(slice));
  };
  both.on_event = [show, then = std::move(callbacks.on_event)](const ScanEvent& event) {
    show(event.kind == ScanEventKind::end_of_data ? "all slices are in" : event.message, true);
    if (then) then(event);
  };
  show("scanning", true);
  return both;
}

void ScanView::linger() const {
  if (!server_) return;
  if (recorder_) recorder_->finish();
  server_->show("the scan is over");
  wait_for_interrupt();
}

}  // namespace sonoloft::tool
