#include "host/apps/tool/live/igtl_output.h"

#include <iostream>
#include <memory>
#include <utility>

#include "host/apps/tool/common_options.h"
#ifdef SONOLOFT_WITH_IGTL
#include "host/igtl/server.h"
#endif

namespace sonoloft::tool {
namespace {

/// One that calls both.
template <class Argument>
std::function<void(Argument)> both(std::function<void(Argument)> first, std::function<void(Argument)> second) {
  if (!first || !second) return first ? first : second;
  return [first = std::move(first), second = std::move(second)](const Argument& argument) {
    first(argument);
    second(argument);
  };
}

#ifdef SONOLOFT_WITH_IGTL
/// Says at the end what became of the clients.
void close(igtl::Server* server) {
  const auto counts = server->counts();
  std::cout << "OpenIGTLink: clients " << counts.accepted << "  surfaces " << counts.surfaces << "  poses "
            << counts.poses << "  frozen " << counts.frozen << "  foreign " << counts.foreign << '\n';
  delete server;
}

Result<ScanCallbacks> serve(const IgtlChoice& choice, const LabelTable& labels) {
  igtl::ServerOptions options;
  options.address = choice.address;
  options.port = *choice.port;
  options.labels = labels;
  auto started = igtl::Server::start(std::move(options));
  if (!started) return tl::unexpected<Error>(started.error());
  const std::shared_ptr<igtl::Server> server(started->release(), close);
  std::cout << "OpenIGTLink: port " << server->port() << " of " << choice.address << std::endl;
  ScanCallbacks callbacks;
  callbacks.on_mesh = [server](auto update) { server->show(std::move(update)); };
  callbacks.on_slice = [server](auto slice) { server->show(std::move(slice)); };
  return callbacks;
}
#else
Result<ScanCallbacks> serve(const IgtlChoice&, const LabelTable&) {
  return fail(ErrorCode::not_available,
              "--igtl is not built in: install OpenIGTLink (Debian: libopenigtlink-dev) and build again");
}
#endif

}  // namespace

void add_igtl(CLI::App& verb, IgtlChoice& choice) {
  auto* igtl = verb.add_option_function<std::uint16_t>(
                       "--igtl", [&choice](const std::uint16_t& port) { choice.port = port; },
                       "Serve meshes and poses to OpenIGTLink clients, on this TCP port; 0: any that is free")
                   ->expected(0, 1)
                   ->default_str("18944");
  verb.add_option("--igtl-address", choice.address,
                  "Address of this machine to serve them at; 0.0.0.0: every one, for everybody who reaches it")
      ->needs(igtl)
      ->capture_default_str();
}

Result<IgtlOutput> IgtlOutput::open(const IgtlChoice& choice, const LabelTable& labels) {
  IgtlOutput output;
  if (!choice.port) return output;
  auto clients = serve(choice, labels);
  if (!clients) return tl::unexpected<Error>(clients.error());
  output.clients_ = std::move(*clients);
  return output;
}

ScanCallbacks IgtlOutput::shown(ScanCallbacks callbacks) const {
  callbacks.on_mesh = both(clients_.on_mesh, std::move(callbacks.on_mesh));
  callbacks.on_slice = both(clients_.on_slice, std::move(callbacks.on_slice));
  return callbacks;
}

}  // namespace sonoloft::tool
