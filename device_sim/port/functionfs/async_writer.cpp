#include "device_sim/port/functionfs/async_writer.h"

#include <linux/aio_abi.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cassert>
#include <cstdint>
#include <ctime>
#include <utility>

namespace sonoloft::device_sim::functionfs {

AsyncWriter::AsyncWriter(int event) : event_(event) {
  syscall(SYS_io_setup, 1, &context_);
}

AsyncWriter::~AsyncWriter() {
  syscall(SYS_io_destroy, context_);
}

void AsyncWriter::begin(int file, std::vector<std::byte> bytes) {
  assert(!busy_);
  bytes_ = std::move(bytes);
  iocb write{};
  write.aio_lio_opcode = IOCB_CMD_PWRITE;
  write.aio_fildes = static_cast<std::uint32_t>(file);
  write.aio_buf = reinterpret_cast<std::uintptr_t>(bytes_.data());
  write.aio_nbytes = bytes_.size();
  write.aio_flags = IOCB_FLAG_RESFD;
  write.aio_resfd = static_cast<std::uint32_t>(event_);
  iocb* all[] = {&write};
  busy_ = syscall(SYS_io_submit, context_, 1, all) == 1;
}

bool AsyncWriter::busy() {
  io_event ended{};
  std::timespec now{};
  if (busy_ && syscall(SYS_io_getevents, context_, 0, 1, &ended, &now) == 1) busy_ = false;
  return busy_;
}

}  // namespace sonoloft::device_sim::functionfs
