#include "device_sim/port/functionfs/functionfs_device.h"

#include <endian.h>
#include <fcntl.h>
#include <linux/usb/functionfs.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "device_sim/port/functionfs/function_words.h"

namespace sonoloft::device_sim::functionfs {

using usb::SetupPacket;
using usb::UrbStatus;

namespace {

constexpr std::size_t kBlockRoom = 16384;  // whole packets
constexpr std::chrono::milliseconds kPause{20};

constexpr const char* kRemedy = ": mount a functionfs there and run as its owner, one program at a time";

bool write_all(int file, std::span<const std::byte> bytes) {
  return ::write(file, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
}

SetupPacket setup_of(const usb_ctrlrequest& request) {
  return {request.bRequestType, request.bRequest, le16toh(request.wValue), le16toh(request.wIndex),
          le16toh(request.wLength)};
}

}  // namespace

FunctionfsDevice::Made FunctionfsDevice::start(protocol::Port& port, const usb::UsbIdentity& identity,
                                               const std::string& directory) {
  Files files;
  auto error = open_files(directory, usb::Descriptors(identity.serial), files);
  if (!error.empty()) {
    close_files(files);
    return {nullptr, std::move(error)};
  }
  std::unique_ptr<FunctionfsDevice> made(new FunctionfsDevice(port, identity, files));
  if (!made->stream_.writer.ready() || !made->events_.writer.ready() || !made->blocks_.ready())
    return {nullptr, "no asynchronous I/O to be had: raise /proc/sys/fs/aio-max-nr"};
  return {std::move(made), {}};
}

// Cause and remedy where they cannot be had. The endpoints' files are there as soon as the function has said what it
// is, in the order in which it said so.
std::string FunctionfsDevice::open_files(const std::string& directory, const usb::Descriptors& descriptors,
                                         Files& files) {
  const std::string control = directory + "/ep0";
  files.control = open(control.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (files.control < 0) return control + " cannot be opened: " + std::strerror(errno) + kRemedy;
  if (!write_all(files.control, function_descriptors(descriptors)) || !write_all(files.control, function_strings())) {
    return control + " does not take the descriptors: " + std::strerror(errno) + kRemedy;
  }
  struct Endpoint {
    int& file;
    const char* name;
    int mode;
  };
  for (const auto& endpoint : {Endpoint{files.stream, "/ep1", O_WRONLY}, Endpoint{files.events, "/ep2", O_WRONLY},
                               Endpoint{files.blobs, "/ep3", O_RDONLY}}) {
    const std::string path = directory + endpoint.name;
    endpoint.file = open(path.c_str(), endpoint.mode | O_NONBLOCK | O_CLOEXEC);
    if (endpoint.file < 0) return path + " cannot be opened: " + std::strerror(errno) + kRemedy;
  }
  return {};
}

void FunctionfsDevice::close_files(const Files& files) {
  for (const int file : {files.blobs, files.events, files.stream, files.control}) {
    if (file >= 0) close(file);
  }
}

FunctionfsDevice::FunctionfsDevice(protocol::Port& port, const usb::UsbIdentity& identity, Files files)
    : files_(files),
      stream_{files.stream, usb::kStreamIn, identity.max_record, 0, AsyncTransfer(completions_.event())},
      events_{files.events, usb::kEventIn, usb::kEventPacket, 0, AsyncTransfer(completions_.event())},
      blocks_(completions_.event()),
      device_(port, identity, [this](const usb::UrbDone& done) { completions_.add(done); }),
      thread_([this] { serve(); }) {}

FunctionfsDevice::~FunctionfsDevice() {
  stopping_ = true;
  completions_.wake();
  thread_.join();
  close_files(files_);
}

void FunctionfsDevice::serve() {
  while (true) {
    auto ended = completions_.take();
    if (stopping_) return;  // looked at after take(), which quiets the event that says so
    for (usb::Completion& done : ended) finish(done);
    ask_for_message(stream_);
    ask_for_message(events_);
    const bool reading = take_block();
    // While the host waits for an answer the file is always ready, for the answer.
    pollfd polled[] = {{completions_.event(), POLLIN, 0}, {answer_id_ != 0 ? -1 : files_.control, POLLIN, 0}};
    if (poll(polled, 2, reading ? -1 : static_cast<int>(kPause.count())) > 0 && polled[1].revents != 0) take_event();
  }
}

void FunctionfsDevice::take_event() {
  usb_functionfs_event event;
  if (::read(files_.control, &event, sizeof event) != sizeof event) return;
  switch (event.type) {
    case FUNCTIONFS_ENABLE:
      enabled_ = true;
      break;
    case FUNCTIONFS_DISABLE:
    case FUNCTIONFS_UNBIND:
      disable();
      break;
    case FUNCTIONFS_SETUP:
      ask(setup_of(event.u.setup));
      break;
    default:
      break;
  }
}

void FunctionfsDevice::disable() {
  enabled_ = false;
  device_.reset();
  stream_.urb = events_.urb = block_id_ = 0;
}

void FunctionfsDevice::ask(const SetupPacket& setup) {
  usb::Urb urb{.id = ++last_id_, .endpoint = 0, .setup = setup, .room = setup.length};
  asked_ = setup;
  if (setup.to_host()) {
    answer_id_ = urb.id;
  } else {
    if (setup.length == 0 || setup.length > protocol::kMaxRequestLen) return stall(setup);
    urb.data.resize(setup.length);
    if (::read(files_.control, urb.data.data(), setup.length) != setup.length) return;  // the host gave up
  }
  device_.submit(std::move(urb));
}

void FunctionfsDevice::ask_for_message(In& in) {
  if (!enabled_ || in.urb != 0 || in.writer.busy()) return;
  in.urb = ++last_id_;
  device_.submit({.id = in.urb, .endpoint = in.endpoint, .room = in.room});
}

// Passes on what was read, then reads. False: nothing can be read for now, which is to be tried again.
bool FunctionfsDevice::take_block() {
  if (!enabled_ || block_id_ != 0 || blocks_.busy()) return true;
  if (std::chrono::steady_clock::now() < next_read_) return false;
  auto block = blocks_.take();
  if (!block.empty()) {
    block_id_ = ++last_id_;
    device_.submit({.id = block_id_, .endpoint = usb::kBlobOut, .data = std::move(block)});
    return true;
  }
  blocks_.read(files_.blobs, kBlockRoom);
  if (blocks_.busy()) return true;
  next_read_ = std::chrono::steady_clock::now() + kPause;
  return false;
}

void FunctionfsDevice::finish(usb::Completion& done) {
  if (done.id == stream_.urb) return finish(stream_, done);
  if (done.id == events_.urb) return finish(events_, done);
  if (done.id == block_id_) {
    block_id_ = 0;
  } else if (done.id == answer_id_) {
    answer_id_ = 0;
    if (done.status != UrbStatus::ok) return stall(asked_);
    (void)write_all(files_.control, done.data);  // else the host gave up
  }
}

void FunctionfsDevice::finish(In& in, usb::Completion& done) {
  in.urb = 0;
  enabled_ &= done.status == UrbStatus::ok;
  if (enabled_) in.writer.write(in.file, std::move(done.data));
}

// By the wrong direction, as functionfs has it.
void FunctionfsDevice::stall(const SetupPacket& setup) {
  const ssize_t stalled = setup.to_host() ? ::read(files_.control, nullptr, 0) : ::write(files_.control, nullptr, 0);
  (void)stalled;
}

}  // namespace sonoloft::device_sim::functionfs
