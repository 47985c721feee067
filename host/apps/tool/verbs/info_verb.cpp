#include <sonoloft/version.h>

#include <iostream>
#include <memory>

#include "core/gpu/make_evaluator.h"
#include "host/apps/tool/phantom/body.h"
#include "host/apps/tool/verbs/verbs.h"

namespace sonoloft::tool {
namespace {

std::string device_line(DeviceChoice choice) {
  const auto evaluator = make_evaluator(choice, 1, {});
  return evaluator ? (*evaluator)->name() : evaluator.error().message;
}

std::string data_line(const char* file, const std::optional<std::filesystem::path>& data) {
  const auto path = find_data(file, data);
  return path ? path->string() : path.error().message;
}

Result<void> print_info(const std::optional<std::filesystem::path>& data) {
  std::cout << "SonoLoft " SONOLOFT_VERSION "\n"
            << "build:   " SONOLOFT_BUILD "\n"
            << "OpenCL:  " << device_line(DeviceChoice::opencl) << "\n"
            << "CPU:     " << device_line(DeviceChoice::cpu) << "\n"
            << "liver:   " << data_line("liver.inr.gz", data) << "\n"
            << "femur:   " << data_line("femur.off", data) << "\n";
  return {};
}

}  // namespace

void add_info(CLI::App& app, Task& task) {
  auto* verb = app.add_subcommand("info", "Says what this program is and what it finds on this machine");
  auto data = std::make_shared<std::optional<std::filesystem::path>>();
  verb->add_option("--data", *data, "Folder of the demo's data");
  verb->callback([&task, data] { task = [data] { return print_info(*data); }; });
}

}  // namespace sonoloft::tool
