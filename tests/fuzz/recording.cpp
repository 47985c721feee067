// Any file: an error or what is in it. Whatever it has of transfers is made ready for a session.
#include <sys/mman.h>
#include <unistd.h>

#include <string>

#include "host/record/replay/recording_index.h"
#include "host/record/replay/replayed_probe.h"
#include "tests/fuzz/input.h"

using namespace sonoloft;

namespace {

/// The fuzzer's bytes as a file without a disk.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size) : file_(memfd_create("fuzz", MFD_CLOEXEC)) {
    fuzz::demand(file_ >= 0 && write(file_, data, size) == static_cast<ssize_t>(size));
  }
  ~MemoryFile() { close(file_); }
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile file(data, size);
  auto index = record::RecordingIndex::of(file.path());
  if (!index) {
    fuzz::demand(!index.error().message.empty());
    return 0;
  }
  record::ReplayedProbe probe(index->info, index->calibration);
  const protocol::StartRequest start{1, protocol::kSliceStream, 0, 1, 0};
  std::byte request[protocol::kMaxRequestLen], reply[protocol::kMaxRequestLen];
  (void)probe.answer(std::span(request).first(
                         protocol::encode_request(protocol::Command::start, 1, protocol::bytes_of(start), request)),
                     reply);
  auto reader = record::RecordingReader::open(file.path());
  fuzz::demand(reader.has_value());
  std::uint64_t transfers = 0;
  for (auto next = reader->next(); next && *next; next = reader->next()) {
    auto* transfer = std::get_if<record::RecordedTransfer>(&(*next)->what);
    if (transfer == nullptr) continue;
    ++transfers;
    for (const auto& id : index->streams)
      if (id) probe.adopt(transfer->bytes, *id);
  }
  fuzz::demand(transfers == index->facts.transfers);
  return 0;
}
