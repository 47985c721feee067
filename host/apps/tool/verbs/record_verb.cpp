#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <iostream>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "host/apps/tool/common_options.h"
#include "host/apps/tool/interrupt.h"
#include "host/apps/tool/live/probe_source.h"
#include "host/apps/tool/verbs/verbs.h"
#include "host/device/session.h"
#include "host/record/recording_transport.h"

namespace sonoloft::tool {
namespace {

constexpr const char* kSuffix = ".mcap";

struct RecordOptions {
  ProbeSource source;
  std::filesystem::path output;
};

/// How a run ended. Threads: any.
class RunEnd {
 public:
  void take(const device::Event& event) {
    if (event.kind != device::EventKind::end_of_data) std::cerr << "sonoloft: " << event.message << '\n';
    const std::lock_guard lock(mutex_);
    data_ended_ |= event.kind == device::EventKind::end_of_data;
    ended_ |= ends_run(event.kind);
    changed_.notify_all();
  }
  bool wait(std::chrono::milliseconds patience) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, patience, [&] { return ended_; });
  }
  bool data_ended() const {
    const std::lock_guard lock(mutex_);
    return data_ended_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false, data_ended_ = false;
};

void print(const record::RecorderFigures& figures) {
  std::printf("%llu records  %.1f MB  %llu not recorded\n", 0ull + figures.transfers,
              static_cast<double>(figures.bytes) * 1e-6, 0ull + figures.not_recorded);
  std::fflush(stdout);
}

/// A run, until it ends by itself, by Ctrl-C or because the disk fails; a line every second.
void follow(RunEnd& end, const record::Recorder& recorder) {
  while (!interrupted() && !recorder.figures().failure && !end.wait(std::chrono::seconds(1))) print(recorder.figures());
}

/// Until the data end, Ctrl-C, or the disk fails. A probe that was unplugged is waited for.
Result<void> record_all(device::Session& session, const record::Recorder& recorder) {
  constexpr std::chrono::milliseconds kLookAgain{200};
  while (!interrupted() && !recorder.figures().failure) {
    RunEnd end;
    const device::Callbacks callbacks{{}, [&](const device::Event& event) { end.take(event); }};
    if (auto started = session.start({}, callbacks); !started) {
      const auto code = started.error().code;
      if (code != ErrorCode::device_not_found && code != ErrorCode::transport_closed) return started;
      std::this_thread::sleep_for(kLookAgain);
      continue;
    }
    follow(end, recorder);
    session.stop();
    if (end.data_ended()) break;
  }
  return {};
}

Result<void> run_record(const RecordOptions& options) {
  auto probe = open_probe(options.source);
  if (!probe) return tl::unexpected<Error>(probe.error());
  const auto recorder = record::Recorder::create(options.output);
  if (!recorder) return tl::unexpected<Error>(recorder.error());
  auto transport = std::make_unique<record::RecordingTransport>(std::move(probe->transport), *recorder);
  const auto session = device::Session::open(std::move(transport));
  if (!session) return tl::unexpected<Error>(session.error());
  note_interrupts();
  const auto done = record_all(**session, **recorder);
  const auto closed = (*recorder)->close();
  print((*recorder)->figures());
  return done ? closed : done;
}

}  // namespace

void add_record(CLI::App& app, Task& task) {
  auto* verb = app.add_subcommand("record", "Records what a probe sends, until the probe ends or Ctrl-C");
  auto options = std::make_shared<RecordOptions>();
  verb->add_option("-o,--output", options->output, std::string("Recording to write, a new file: ") + kSuffix)
      ->required()
      ->check(ends_in(kSuffix));
  add_probe_source(*verb, options->source);
  verb->callback([&task, options] { task = [options] { return run_record(*options); }; });
}

}  // namespace sonoloft::tool
