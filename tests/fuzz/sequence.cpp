// The reader of tracked sequences (.igs.mha, .igs.nrrd).
#include "core/io/sequences/tracked_sequence.h"
#include "tests/fuzz/input.h"

using namespace sonoloft;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto sequence = parse_tracked_sequence(fuzz::text(data, size), "fuzzed");
  if (!sequence) {
    fuzz::demand(sequence.error().message.starts_with("fuzzed"));
    return 0;
  }
  const auto& dims = sequence->images.dims;
  fuzz::demand(sequence->frames.size() == dims[2]);
  fuzz::demand(sequence->images.pixels.size() == std::size_t{dims[0]} * dims[1] * dims[2]);
  return 0;
}
