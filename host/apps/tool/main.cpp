// sonoloft: the command-line tool. Exit status: 0 done, 1 failed, 2 not understood.
#include <sonoloft/version.h>

#include <iostream>
#include <string>

#include "host/apps/tool/verbs/verbs.h"

int main(int argc, char** argv) {
  using namespace sonoloft::tool;
  CLI::App app("SonoLoft " SONOLOFT_VERSION ": a tracked ultrasound probe in, live multi-label 3D surfaces out.");
  app.require_subcommand(1);
  app.fallthrough(false);
  Task task;
  add_demo(app, task);
  add_reconstruct(app, task);
  add_evaluate(app, task);
  add_scan(app, task);
  add_record(app, task);
  add_replay(app, task);
  add_view_verb(app, task);
  add_devices(app, task);
  add_probe(app, task);
  add_send(app, task);
  add_stats(app, task);
  add_calibrate_time(app, task);
  add_info(app, task);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(e);
    const auto verbs = app.get_subcommands();
    const std::string verb = verbs.empty() ? "" : verbs[0]->get_name() + " ";
    const std::string cause = verbs.empty() && argc > 1 ? "there is no verb " + std::string(argv[1]) : e.what();
    std::cerr << "sonoloft: " << cause << ": see sonoloft " << verb << "--help\n";
    return 2;
  }
  try {
    if (const auto done = task(); !done) {
      std::cerr << "sonoloft: " << done.error().message << '\n';
      return 1;
    }
  } catch (const std::exception& e) {
    std::cerr << "sonoloft: " << e.what() << '\n';
    return 1;
  }
  return 0;
}
