#pragma once
// page -> ScanView -> [SCAN RECORDER] -> RecordingTransport -> recording-N.mcap
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "host/record/recording_transport.h"
#include "host/view/view_server.h"

namespace sonoloft::tool {

/// Recordings of a running scan that begin and end when a page asks for it. Threads: any; files are made and closed on
/// one of its own, so that nobody waits for a disk.
class ScanRecorder {
 public:
  /// @param folder     made when it is needed; recordings get the first free number in it
  /// @pre   `transport` outlives the recorder
  ScanRecorder(record::RecordingTransport& transport, std::filesystem::path folder);
  /// Finishes.
  ~ScanRecorder();
  ScanRecorder(const ScanRecorder&) = delete;
  ScanRecorder& operator=(const ScanRecorder&) = delete;

  /// Where to show how far a recording is.
  void show_on(std::weak_ptr<view::ViewServer> server);
  /// There is to be a recording, or none: noted, and done soon.
  void ask(bool recording);
  /// Ends what is recorded and says on stdout what is in which file. Nothing is recorded any more.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  void work();
  // The working thread's:
  void begin();
  void end();
  void show();

  record::RecordingTransport& transport_;
  const std::filesystem::path folder_;

  // The working thread's, then that of finish().
  std::shared_ptr<record::Recorder> recorder_;  ///< of the recording that goes on
  std::filesystem::path path_;
  Clock::time_point begun_;
  view::ViewRecording shown_;
  std::vector<std::string> ended_;  ///< a line for each recording

  std::mutex mutex_;  ///< guards what follows
  std::condition_variable changed_;
  std::weak_ptr<view::ViewServer> server_;
  std::optional<bool> asked_;
  bool finishing_ = false;

  std::thread worker_;
};

}  // namespace sonoloft::tool
