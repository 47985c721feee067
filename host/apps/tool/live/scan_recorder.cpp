#include "host/apps/tool/live/scan_recorder.h"

#include <chrono>
#include <iostream>
#include <sstream>
#include <system_error>
#include <utility>

namespace sonoloft::tool {
namespace {

constexpr std::chrono::milliseconds kShowPeriod{250};

std::filesystem::path free_name(const std::filesystem::path& folder) {
  for (int n = 1;; ++n) {
    auto path = folder / ("recording-" + std::to_string(n) + ".mcap");
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return path;
  }
}

std::string line_of(const std::filesystem::path& path, const record::RecorderFigures& figures) {
  std::ostringstream line;
  line << "recorded: " << path.string() << "  " << figures.transfers << " records  " << figures.not_recorded
       << " not recorded";
  if (figures.failure) line << ": " << figures.failure->message;
  return line.str();
}

}  // namespace

ScanRecorder::ScanRecorder(record::RecordingTransport& transport, std::filesystem::path folder)
    : transport_(transport), folder_(std::move(folder)), worker_([this] { work(); }) {}

ScanRecorder::~ScanRecorder() {
  finish();
}

void ScanRecorder::show_on(std::weak_ptr<view::ViewServer> server) {
  const std::lock_guard lock(mutex_);
  server_ = std::move(server);
}

void ScanRecorder::ask(bool recording) {
  const std::lock_guard lock(mutex_);
  asked_ = recording;
  changed_.notify_all();
}

void ScanRecorder::finish() {
  if (!worker_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    finishing_ = true;
    changed_.notify_all();
  }
  worker_.join();
  for (const std::string& line : ended_) std::cout << line << std::endl;
}

void ScanRecorder::work() {
  std::unique_lock lock(mutex_);
  for (bool going = true; going;) {
    changed_.wait_for(lock, kShowPeriod, [this] { return finishing_ || asked_; });
    going = !finishing_;
    const bool recording = std::exchange(asked_, {}).value_or(recorder_ != nullptr) && going;
    lock.unlock();
    if (recording && !recorder_) begin();
    if (recorder_ && (!recording || recorder_->figures().failure)) end();
    if (recorder_) show();
    lock.lock();
  }
}

void ScanRecorder::begin() {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);  // the recorder says what comes of it
  path_ = free_name(folder_);
  auto recorder = record::Recorder::create(path_);
  shown_ = {};
  shown_.file = path_.filename().string();
  if (!recorder) {
    shown_.failure = recorder.error().message;
    return show();
  }
  recorder_ = std::move(*recorder);
  begun_ = Clock::now();
  shown_.running = true;
  transport_.record(recorder_);
}

void ScanRecorder::end() {
  transport_.end_recording();
  (void)recorder_->close();  // what failed is among the figures
  ended_.push_back(line_of(path_, recorder_->figures()));
  shown_.running = false;
  show();
  recorder_.reset();
}

void ScanRecorder::show() {
  if (recorder_) {
    const record::RecorderFigures figures = recorder_->figures();
    shown_.seconds = std::chrono::duration<double>(Clock::now() - begun_).count();
    shown_.records = figures.transfers;
    shown_.not_recorded = figures.not_recorded;
    if (figures.failure) shown_.failure = figures.failure->message;
  }
  std::unique_lock lock(mutex_);
  const auto server = server_.lock();
  lock.unlock();
  if (server) server->show(shown_);
}

}  // namespace sonoloft::tool
