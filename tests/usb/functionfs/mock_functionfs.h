#pragma once
#include <linux/usb/functionfs.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace sonoloft::test {

/// A folder that looks like a mounted functionfs: its ep0 is a terminal, whose other end plays the kernel; the others
/// are pipes. A zero-length read or write, which stalls, shows by what does not come.
class MockFunctionfs {
 public:
  MockFunctionfs();
  ~MockFunctionfs();
  MockFunctionfs(const MockFunctionfs&) = delete;
  MockFunctionfs& operator=(const MockFunctionfs&) = delete;

  [[nodiscard]] std::string folder() const { return folder_.path("").string(); }

  /// What the function wrote to ep0; all of `size`, waiting for at most 60 s.
  [[nodiscard]] std::vector<std::byte> from_control(std::size_t size);
  /// A record, taken from ep1.
  [[nodiscard]] std::vector<std::byte> record();
  [[nodiscard]] bool silent() const;  ///< on ep1, for now
  void drain();                       ///< what is in ep1
  /// An event, taken from ep2.
  [[nodiscard]] std::vector<std::byte> event();
  /// A transfer from the host, on ep3.
  void send_block(std::span<const std::byte> block);

  void happen(usb_functionfs_event_type type);
  /// A control transfer begins; to the device with its data.
  void set_up(std::uint8_t request_type, std::uint8_t request, std::uint16_t length,
              std::span<const std::byte> data = {});

 private:
  void send(const usb_functionfs_event& event, std::span<const std::byte> data);

  TemporaryFolder folder_;
  int kernel_ = -1, terminal_ = -1, host_ = -1, events_ = -1, blobs_ = -1;
};

}  // namespace sonoloft::test
