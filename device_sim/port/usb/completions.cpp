#include "device_sim/port/usb/completions.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <utility>

namespace sonoloft::device_sim::usb {

Completions::Completions() : event_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

Completions::~Completions() {
  close(event_);
}

void Completions::add(const UrbDone& done) {
  const std::lock_guard lock(mutex_);
  waiting_.push_back({done.id, done.status, {done.data.begin(), done.data.end()}, done.size});
  eventfd_write(event_, 1);
}

void Completions::wake() {
  eventfd_write(event_, 1);
}

std::vector<Completion> Completions::take() {
  eventfd_t ignored;
  eventfd_read(event_, &ignored);
  const std::lock_guard lock(mutex_);
  return std::exchange(waiting_, {});
}

}  // namespace sonoloft::device_sim::usb
