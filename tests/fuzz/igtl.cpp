// What a client of the OpenIGTLink server sends: whatever the pieces in which it comes, the same requests are read. The
// first byte says how long the pieces are.
#include "host/igtl/wire/request_reader.h"
#include "tests/fuzz/input.h"

using namespace sonoloft;
using igtl::Request;
using igtl::RequestReader;

namespace {

bool same(const Request& a, const Request& b) {
  return a.type == b.type && a.device == b.device && a.version == b.version && a.body == b.body && a.sound == b.sound;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const std::size_t piece = 1 + input.number<std::uint8_t>() * std::size_t{16};
  const auto bytes = input.rest();
  RequestReader whole;
  const auto all = whole.take(bytes);
  if (all)
    for (const Request& request : *all)
      fuzz::demand(request.body.size() <= RequestReader::kMaxKept && (request.sound || request.body.empty()));

  RequestReader pieces;
  std::size_t read = 0;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    const auto some = pieces.take(bytes.subspan(at, std::min(piece, bytes.size() - at)));
    if (!some) {
      fuzz::demand(!all);
      return 0;
    }
    for (const Request& request : *some) {
      fuzz::demand(!all || (read < all->size() && same(request, (*all)[read])));
      ++read;
    }
  }
  fuzz::demand(all && read == all->size());
  return 0;
}
