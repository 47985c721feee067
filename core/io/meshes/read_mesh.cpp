#include <algorithm>
#include <string>

#include "core/io/byte_file.h"
#include "core/io/meshes/mesh_files.h"
#include "core/io/meshes/mesh_parsers.h"

namespace sonoloft {

Result<IndexedMesh> read_mesh(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  const auto parser = ending == ".ply"   ? parse_ply
                      : ending == ".stl" ? parse_stl
                      : ending == ".obj" ? parse_obj
                      : ending == ".off" ? parse_off
                                         : nullptr;
  if (parser == nullptr)
    return fail(ErrorCode::unsupported_format,
                path.string() + ": not a mesh that we read: give a .ply, .stl, .obj or .off");
  return read_bytes(path).and_then([&](const std::string& bytes) { return parser(bytes, path.filename().string()); });
}

}  // namespace sonoloft
