// The readers of recorded slices: PARSE is one of them.
#include "core/io/slices/slice_files.h"
#include "tests/fuzz/input.h"

using namespace sonoloft;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = PARSE(fuzz::text(data, size), "fuzzed");
  if (!file) {
    fuzz::demand(file.error().message.starts_with("fuzzed"));
    return 0;
  }
  for (const TrackedSlice& slice : file->slices) {
    fuzz::demand(slice.image_to_reference.matrix().allFinite());
    for (const Contour& c : slice.contours) {
      fuzz::demand(c.count >= 3 && std::uint64_t{c.first} + c.count <= slice.points.size());
    }
  }
  return 0;
}
