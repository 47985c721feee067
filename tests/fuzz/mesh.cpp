// The readers of meshes. The first byte says which.
#include <array>

#include "core/io/meshes/mesh_parsers.h"
#include "tests/fuzz/input.h"

using namespace sonoloft;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array kParsers{parse_ply, parse_stl, parse_obj, parse_off};
  fuzz::Input input(data, size);
  const auto parse = kParsers[input.number<std::uint8_t>() % kParsers.size()];
  const auto bytes = input.rest();
  const auto mesh = parse({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "fuzzed");
  if (!mesh) {
    fuzz::demand(mesh.error().message.starts_with("fuzzed"));
    return 0;
  }
  fuzz::demand(mesh->label_front.size() == mesh->triangles.size() && mesh->label_back.size() == mesh->triangles.size());
  for (const auto& position : mesh->positions) fuzz::demand(position.allFinite());
  for (const auto& triangle : mesh->triangles) {
    for (const auto corner : triangle) fuzz::demand(corner < mesh->positions.size());
  }
  return 0;
}
