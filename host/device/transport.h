#pragma once
#include <chrono>
#include <cstddef>
#include <span>

#include "core/slice/result.h"

// bus -> [TRANSPORT] -> transfers -> session -> slices

namespace sonoloft::device {

/// Where a transport puts what it receives. Called on the transport's event thread only, one call at a time; events may
/// have a thread of their own, so that they come while on_transfer() blocks.
class TransferSink {
 public:
  /// One finished transfer of the stream, whatever its bytes are.
  /// @pre  transfer.data() is 64-byte aligned; the bytes are valid during the call only
  /// @post does not throw; may block, which keeps later transfers waiting on the device's side
  virtual void on_transfer(std::span<const std::byte> transfer) = 0;

  /// Something that the device tells by itself, whatever its bytes are; valid during the call only.
  /// @post does not throw and does not block
  virtual void on_event(std::span<const std::byte> event) { (void)event; }

  /// The device went away; nothing follows. At most once between start_stream() and stop_stream().
  virtual void on_gone() = 0;

 protected:
  ~TransferSink() = default;
};

/// A way to reach one opened device: requests with their replies, and a stream of transfers. Implementations know
/// buses and nothing of what the bytes mean.
///
/// Threads. control() may be called from any thread but the event thread; calls wait for each other. start_stream() and
/// stop_stream() are called by one thread at a time, never from the event thread. The event thread is the transport's
/// own; it exists at least from start_stream() to stop_stream().
///
/// Lifetime. A transport is born open and closes when destroyed; @pre of the destructor: the stream is stopped. After
/// the device went away every call returns transport_closed at once, until reopen() found it again.
class Transport {
 public:
  virtual ~Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;

  /// One request and its reply.
  /// @pre    reply.size() >= protocol::kMaxRequestLen
  /// @return the reply's length
  /// @error  transport_closed, timed_out, io_failed
  [[nodiscard]] virtual Result<std::size_t> control(std::span<const std::byte> request, std::span<std::byte> reply,
                                                    std::chrono::milliseconds timeout) = 0;

  /// Throws away what an earlier session left in the pipe, then receives transfers of up to `max_record` bytes into
  /// buffers of its own and hands them to `sink`, in order, until stop_stream().
  /// @pre   the device does not stream yet; `sink` lives until stop_stream() returns
  /// @error transport_closed, io_failed: nothing was started
  [[nodiscard]] virtual Result<void> start_stream(TransferSink& sink, std::size_t max_record) = 0;

  /// Ends the stream: no transfer begins any more, those under way are cancelled, and the call returns after the last
  /// call into the sink has returned. A transfer that had finished before is still handed over, not lost.
  /// Legal when no stream runs and after the device went away. @cost under 100 ms beyond the sink's own time
  virtual void stop_stream() = 0;

  /// The stream stands still though the device has something to send: takes back what waits on this side, clears what
  /// hinders it on the other, and goes on. From any thread but the event thread, while a stream runs. Buses without
  /// such states have nothing to do.
  virtual void restart_stream() {}

  /// That did not help: resets the device as its bus can, and the stream goes on; the device's session outlives it.
  /// Returns when it is done or has failed, which the sink hears of as of a device that went away. From any thread but
  /// the event thread, while a stream runs and no request is under way.
  virtual void reset_stream() {}

  /// Sends one block of a blob; the answer to GET_BLOB tells whether it arrived. From any thread but the event thread,
  /// while no stream runs.
  /// @error not_available: this way to the device takes none; transport_closed, timed_out, io_failed
  [[nodiscard]] virtual Result<void> send_block(std::span<const std::byte> block, std::chrono::milliseconds timeout) {
    (void)block, (void)timeout;
    return fail(ErrorCode::not_available, "this way to the device takes no blobs: connect it by USB");
  }

  /// Looks for the device again after it went away, or resets one that does not come to its senses, so that a session
  /// can go on with it. @pre no stream runs, no other call is under way
  /// @error transport_closed: this bus cannot, or the device is not back; device_not_found, io_failed
  [[nodiscard]] virtual Result<void> reopen() {
    return fail(ErrorCode::transport_closed, "the device was unplugged: plug it in and open it again");
  }

 protected:
  Transport() = default;
};

}  // namespace sonoloft::device
