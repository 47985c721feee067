#pragma once
// The command line: main -> [VERBS] -> core, host/scan, device_sim
#include <CLI/CLI.hpp>
#include <functional>

#include "core/slice/result.h"

namespace sonoloft::tool {

/// What is to be done once the whole command line is understood.
using Task = std::function<Result<void>()>;

// Each declares a verb with its options; when the verb is on the command line, `task` becomes its work.
// @pre `task` outlives `app`
void add_demo(CLI::App& app, Task& task);
void add_reconstruct(CLI::App& app, Task& task);
void add_evaluate(CLI::App& app, Task& task);
void add_info(CLI::App& app, Task& task);
void add_scan(CLI::App& app, Task& task);
void add_record(CLI::App& app, Task& task);
void add_replay(CLI::App& app, Task& task);
void add_devices(CLI::App& app, Task& task);
void add_probe(CLI::App& app, Task& task);
void add_send(CLI::App& app, Task& task);
void add_stats(CLI::App& app, Task& task);
void add_view_verb(CLI::App& app, Task& task);
void add_calibrate_time(CLI::App& app, Task& task);

}  // namespace sonoloft::tool
