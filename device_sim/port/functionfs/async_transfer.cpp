#include "device_sim/port/functionfs/async_transfer.h"

#include <linux/aio_abi.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <ctime>
#include <utility>

namespace sonoloft::device_sim::functionfs {

AsyncTransfer::AsyncTransfer(int event) : event_(event) {
  syscall(SYS_io_setup, 1, &context_);
}

AsyncTransfer::~AsyncTransfer() {
  syscall(SYS_io_destroy, context_);
}

void AsyncTransfer::write(int file, std::vector<std::byte> bytes) {
  assert(!busy_);
  bytes_ = std::move(bytes);
  begin(file, IOCB_CMD_PWRITE);
}

void AsyncTransfer::read(int file, std::size_t room) {
  assert(!busy_);
  bytes_.resize(room);
  begin(file, IOCB_CMD_PREAD);
}

void AsyncTransfer::begin(int file, std::uint16_t what) {
  iocb transfer{};
  transfer.aio_lio_opcode = what;
  transfer.aio_fildes = static_cast<std::uint32_t>(file);
  transfer.aio_buf = reinterpret_cast<std::uintptr_t>(bytes_.data());
  transfer.aio_nbytes = bytes_.size();
  transfer.aio_flags = IOCB_FLAG_RESFD;
  transfer.aio_resfd = static_cast<std::uint32_t>(event_);
  iocb* all[] = {&transfer};
  busy_ = syscall(SYS_io_submit, context_, 1, all) == 1;
  if (!busy_) bytes_.clear();
}

bool AsyncTransfer::busy() {
  io_event ended{};
  std::timespec now{};
  if (busy_ && syscall(SYS_io_getevents, context_, 0, 1, &ended, &now) == 1) {
    busy_ = false;
    bytes_.resize(std::min(static_cast<std::size_t>(std::max<std::int64_t>(ended.res, 0)), bytes_.size()));
  }
  return busy_;
}

std::vector<std::byte> AsyncTransfer::take() {
  assert(!busy_);
  return std::exchange(bytes_, {});
}

}  // namespace sonoloft::device_sim::functionfs
