#include <iostream>
#include <map>
#include <memory>
#include <span>

#include "core/io/byte_file.h"
#include "host/apps/tool/live/probe_source.h"
#include "host/apps/tool/verbs/verbs.h"
#include "host/device/session.h"

namespace sonoloft::tool {
namespace {

struct SendOptions {
  ProbeSource source;
  device::BlobKind kind = device::BlobKind::firmware;
  std::string file;
};

Result<void> send(const SendOptions& options) {
  const auto bytes = read_bytes(options.file);
  if (!bytes) return tl::unexpected<Error>(bytes.error());
  auto probe = open_probe(options.source);
  if (!probe) return tl::unexpected<Error>(probe.error());
  const auto session = device::Session::open(std::move(probe->transport));
  if (!session) return tl::unexpected<Error>(session.error());
  if (auto sent = (*session)->send_blob(options.kind, std::as_bytes(std::span(*bytes))); !sent) return sent;
  std::cout << bytes->size() << " bytes sent, and kept by the probe\n";
  return {};
}

}  // namespace

void add_send(CLI::App& app, Task& task) {
  auto* verb = app.add_subcommand("send", "Sends a file to a probe, which keeps it");
  auto options = std::make_shared<SendOptions>();
  const std::map<std::string, device::BlobKind> kinds{{"firmware", device::BlobKind::firmware},
                                                      {"calibration", device::BlobKind::calibration}};
  verb->add_option("kind", options->kind, "What it is: firmware, or calibration (what its maker measured)")
      ->required()
      ->transform(CLI::CheckedTransformer(kinds));
  verb->add_option("file", options->file, "The file, as it is")->required();
  add_probe_source(*verb, options->source);
  verb->callback([&task, options] { task = [options] { return send(*options); }; });
}

}  // namespace sonoloft::tool
