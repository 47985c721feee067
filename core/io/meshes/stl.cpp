#include <Eigen/Geometry>
#include <array>
#include <string>
#include <unordered_map>

#include "core/io/byte_file.h"
#include "core/io/byte_order.h"
#include "core/io/meshes/mesh_builder.h"
#include "core/io/meshes/mesh_files.h"
#include "core/io/meshes/mesh_parsers.h"
#include "core/io/text_scanner.h"

namespace sonoloft {
namespace {

constexpr std::size_t kHeaderBytes = 84, kFacetBytes = 50;

/// STL repeats a vertex in every triangle: equal positions become one.
class Joiner {
 public:
  explicit Joiner(MeshBuilder& mesh) : mesh_(mesh) {}

  std::uint32_t index_of(const Eigen::Vector3f& p) {
    Key key;
    for (int c = 0; c < 3; ++c) key[static_cast<std::size_t>(c)] = std::bit_cast<std::uint32_t>(p[c] + 0.0f);  // no -0
    const auto [entry, is_new] = known_.try_emplace(key, mesh_.position_count());
    if (is_new) mesh_.add_position(p.cast<double>());
    return entry->second;
  }

 private:
  using Key = std::array<std::uint32_t, 3>;
  struct Hash {
    std::size_t operator()(const Key& k) const {
      std::uint64_t h = k[0] * 0x9E3779B97F4A7C15ull + k[1];
      h = (h ^ (h >> 32)) * 0xC2B2AE3D27D4EB4Full + k[2];
      return static_cast<std::size_t>((h ^ (h >> 29)) * 0x165667B19E3779F9ull);
    }
  };
  MeshBuilder& mesh_;
  std::unordered_map<Key, std::uint32_t, Hash> known_;
};

Result<IndexedMesh> parse_binary(std::string_view bytes, const std::string& name) {
  MeshBuilder mesh;
  Joiner joiner(mesh);
  for (std::size_t at = kHeaderBytes; at < bytes.size(); at += kFacetBytes) {
    std::array<std::uint32_t, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto coordinate = [&](std::size_t c) { return load<float>(bytes, at + 12 + 12 * k + 4 * c); };
      corners[k] = joiner.index_of({coordinate(0), coordinate(1), coordinate(2)});
    }
    mesh.add_polygon(corners);
  }
  return std::move(mesh).finish(name);
}

Result<IndexedMesh> parse_ascii(std::string_view text, const std::string& name) {
  TextScanner in(text, name);
  MeshBuilder mesh;
  Joiner joiner(mesh);
  std::array<std::uint32_t, 3> corners{};
  std::size_t corner_count = 0;
  while (!in.failed()) {
    const std::string_view word = in.word("endsolid");
    if (word == "endsolid") break;
    if (word == "solid") in.skip_line();  // its name may be any words
    if (word != "vertex") continue;
    corners[corner_count++ % 3] = joiner.index_of(in.vector("a coordinate").cast<float>());
    if (corner_count % 3 == 0) mesh.add_polygon(corners);
  }
  if (in.failed()) return in.failure();
  return std::move(mesh).finish(name);
}

}  // namespace

Result<IndexedMesh> parse_stl(std::string_view bytes, const std::string& name) {
  const bool has_header = bytes.size() >= kHeaderBytes;
  const std::uint64_t declared = has_header ? load<std::uint32_t>(bytes, kHeaderBytes - 4) : 0;
  if (has_header && bytes.size() == kHeaderBytes + kFacetBytes * declared) return parse_binary(bytes, name);
  if (bytes.starts_with("solid")) return parse_ascii(bytes, name);
  return fail(ErrorCode::parse_failed,
              name + ": neither text nor of the length that its header declares: the file is truncated or no STL");
}

Result<void> write_stl(const IndexedMesh& mesh, const std::filesystem::path& path) {
  std::string out = "SonoLoft; millimetres; SPACE=LPS";
  out.resize(kHeaderBytes - 4, ' ');
  out.reserve(kHeaderBytes + kFacetBytes * mesh.triangles.size());
  append(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  const auto append_vector = [&](const Eigen::Vector3f& v) {
    for (const float c : {v.x(), v.y(), v.z()}) append(out, c);
  };
  for (const auto& [i, j, k] : mesh.triangles) {
    const Eigen::Vector3f &a = mesh.positions[i], &b = mesh.positions[j], &c = mesh.positions[k];
    append_vector((b - a).cross(c - a).stableNormalized());
    for (const Eigen::Vector3f& corner : {a, b, c}) append_vector(corner);
    append(out, std::uint16_t{0});
  }
  return write_bytes(path, out);
}

}  // namespace sonoloft
