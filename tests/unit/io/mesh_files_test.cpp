#include "core/io/meshes/mesh_files.h"

#include <doctest/doctest.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include "tests/support/temporary_folder.h"

using namespace sonoloft;
using test::TemporaryFolder;

namespace {

/// Two tetrahedra that share a face: labels 1 and 7 against outside and against each other; awkward coordinates.
IndexedMesh two_tetrahedra() {
  IndexedMesh mesh;
  mesh.positions = {{0.1f, 0, 0}, {1, 1e-7f, 0}, {0, 1.0f / 3, 0}, {0.25f, 0.25f, 1e4f}, {0.3f, 0.3f, -2.5f}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}};
  mesh.label_front = {1, 0, 0, 0, 7, 0, 0};
  mesh.label_back = {7, 1, 1, 1, 0, 7, 7};  // one has outside behind
  return mesh;
}

/// Label 1 has a name and a colour.
LabelTable named_liver() {
  LabelTable labels;
  REQUIRE(labels.add(1, "liver", {9, 80, 255}));
  return labels;
}

IndexedMesh read(const std::filesystem::path& path) {
  auto mesh = read_mesh(path);
  REQUIRE_MESSAGE(mesh.has_value(), (mesh ? "" : mesh.error().message));
  return *mesh;
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Triangles with their labels as corner positions, in any order.
std::multiset<std::string> as_set(const IndexedMesh& mesh, bool with_labels) {
  std::multiset<std::string> set;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::ostringstream line;
    line << std::hexfloat;
    for (const std::uint32_t corner : mesh.triangles[t]) line << mesh.positions[corner].transpose() << " | ";
    if (with_labels) line << mesh.label_front[t] << ' ' << mesh.label_back[t];
    set.insert(line.str());
  }
  return set;
}

std::string base64_decoded(std::string_view text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t group = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    group = (group << 6) | static_cast<std::uint32_t>(digits.find(c));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>((group >> bits) & 255);
  }
  return bytes;
}

/// Every opening tag is closed in order; quotes are paired. Counts the tags.
int checked_xml_tags(const std::string& text) {
  std::vector<std::string> open;
  int tags = 0;
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1)) {
    const std::size_t end = text.find('>', at);
    REQUIRE(end != std::string::npos);
    const std::string tag = text.substr(at + 1, end - at - 1);
    CHECK(std::count(tag.begin(), tag.end(), '"') % 2 == 0);
    CHECK(tag.find('<') == std::string::npos);
    const std::string name = tag.substr(0, tag.find_first_of(" /", 1));
    ++tags;
    if (tag.starts_with('?') || tag.ends_with('/')) continue;
    if (!tag.starts_with('/')) {
      open.push_back(name);
      continue;
    }
    REQUIRE_FALSE(open.empty());
    CHECK(open.back() == tag.substr(1));
    open.pop_back();
  }
  CHECK(open.empty());
  return tags;
}

/// The contents of an appended array of a VTP file, by its name.
template <class T>
std::vector<T> vtp_array(const std::string& text, const std::string& name) {
  const std::size_t tag = text.find("Name=\"" + name + "\"");
  const std::size_t offset_at = text.find("offset=\"", tag) + 8;
  const std::size_t data = text.find('_', text.find("<AppendedData")) + 1;
  const std::string bytes = base64_decoded(std::string_view(text).substr(data + std::stoul(text.substr(offset_at))));
  std::uint64_t size = 0;
  std::memcpy(&size, bytes.data(), sizeof size);
  REQUIRE(size % sizeof(T) == 0);
  REQUIRE(bytes.size() >= 8 + size);
  std::vector<T> values(size / sizeof(T));
  std::memcpy(values.data(), bytes.data() + 8, size);
  return values;
}

}  // namespace

TEST_CASE("mesh files: a PLY comes back with every bit of its positions, its order and its labels") {
  const TemporaryFolder folder;
  const IndexedMesh mesh = two_tetrahedra();
  REQUIRE(write_ply(mesh, folder.path("m.ply")).has_value());
  const IndexedMesh back = read(folder.path("m.ply"));
  CHECK(back.positions == mesh.positions);
  CHECK(back.triangles == mesh.triangles);
  CHECK(back.label_front == mesh.label_front);
  CHECK(back.label_back == mesh.label_back);
  const std::string bytes = bytes_of(folder.path("m.ply"));
  CHECK(bytes.find("comment SPACE=LPS\n") != std::string::npos);
  CHECK(bytes.size() == bytes.find("end_header\n") + 11 + 12 * mesh.positions.size() + 20 * mesh.triangles.size());
}

TEST_CASE("mesh files: an OBJ comes back with every bit of its positions and the labels of its groups") {
  const TemporaryFolder folder;
  const IndexedMesh mesh = two_tetrahedra();
  REQUIRE(write_obj(mesh, folder.path("m.obj")).has_value());
  const IndexedMesh back = read(folder.path("m.obj"));
  CHECK(back.positions == mesh.positions);
  CHECK(as_set(back, true) == as_set(mesh, true));
  const std::string text = bytes_of(folder.path("m.obj"));
  CHECK(text.find("# SPACE=LPS\n") != std::string::npos);
  CHECK(text.find("\nf 1 ") == std::string::npos);  // see docs/meshes.md
  CHECK(text.find("\nf 2 ") != std::string::npos);
}

TEST_CASE("mesh files: positions that no triangle uses are left out, the others keep their order") {
  const TemporaryFolder folder;
  const IndexedMesh mesh =
      read(folder.write("m.obj", "v 9 9 9\nv 0 0 0\nv 8 8 8\nv 1 0 0\nv 0 1 0\nv 7 7 7\nf 2 4 5\n"));
  CHECK(mesh.positions == std::vector<Eigen::Vector3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  CHECK(mesh.triangles == std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}});
}

TEST_CASE("mesh files: PLY and OBJ say what the labels are called and how they look") {
  const TemporaryFolder folder;
  const IndexedMesh mesh = two_tetrahedra();
  REQUIRE(write_ply(mesh, folder.path("m.ply"), named_liver()).has_value());
  const std::string ply = bytes_of(folder.path("m.ply"));
  CHECK(ply.find("\ncomment label 1 9 80 255 liver\n") != std::string::npos);
  CHECK(ply.find(" label 7\nelement") != std::string::npos);
  const std::size_t second = ply.find("end_header\n") + 11 + 12 * mesh.positions.size() + 20;
  CHECK(ply.substr(second + 17, 3) == "\x09\x50\xff");

  LabelTable labels = named_liver();
  REQUIRE(labels.add(7, "liver", {255, 0, 0}));  // two of one name
  REQUIRE(write_obj(mesh, folder.path("m.obj"), labels).has_value());
  const std::string obj = bytes_of(folder.path("m.obj")), materials = bytes_of(folder.path("m.mtl"));
  CHECK(obj.find("\nmtllib m.mtl\n") != std::string::npos);
  CHECK(obj.find("g front_0_back_1\nusemtl liver\n") != std::string::npos);
  CHECK(obj.find("g front_1_back_7\nusemtl liver_7\n") != std::string::npos);
  CHECK(obj.find("g front_7_back_0\nusemtl liver_7\n") != std::string::npos);
  CHECK(materials.find("newmtl liver\nKd 0.03529412 0.3137255 1\n") != std::string::npos);
  CHECK(materials.find("newmtl liver_7\nKd 1 0 0\n") != std::string::npos);
}

TEST_CASE("mesh files: an STL comes back with its vertices joined and without labels") {
  const TemporaryFolder folder;
  const IndexedMesh mesh = two_tetrahedra();
  REQUIRE(write_stl(mesh, folder.path("m.STL")).has_value());
  const IndexedMesh back = read(folder.path("m.STL"));
  CHECK(back.positions.size() == mesh.positions.size());
  CHECK(as_set(back, false) == as_set(mesh, false));
  CHECK(back.label_back == std::vector<Label>(7, 1));
  const std::string bytes = bytes_of(folder.path("m.STL"));
  CHECK(bytes.substr(0, 80).find("SPACE=LPS") != std::string::npos);
  CHECK_FALSE(bytes.starts_with("solid"));
}

TEST_CASE("mesh files: a VTP is well-formed and its arrays hold the mesh, outside never first") {
  const TemporaryFolder folder;
  const IndexedMesh mesh = two_tetrahedra();
  REQUIRE(write_vtp(mesh, folder.path("m.vtp"), named_liver()).has_value());
  const std::string text = bytes_of(folder.path("m.vtp"));
  CHECK(checked_xml_tags(text) == 27);
  CHECK(text.find("NumberOfPoints=\"5\" NumberOfPolys=\"7\"") != std::string::npos);
  CHECK(text.find("Name=\"SPACE\" NumberOfTuples=\"1\" format=\"ascii\">76 80 83 0 <") != std::string::npos);

  CHECK(text.find("Name=\"LabelNames\" NumberOfTuples=\"2\" format=\"ascii\">108 105 118 101 114 0 ") !=
        std::string::npos);
  CHECK(vtp_array<std::uint16_t>(text, "LabelValues") == std::vector<std::uint16_t>{1, 7});
  const Rgb seven = label_colour(7);
  CHECK(vtp_array<std::uint8_t>(text, "LabelColors") ==
        std::vector<std::uint8_t>{9, 80, 255, seven[0], seven[1], seven[2]});

  const auto points = vtp_array<float>(text, "Points");
  const auto corners = vtp_array<std::int64_t>(text, "connectivity");
  const auto offsets = vtp_array<std::int64_t>(text, "offsets");
  const auto labels = vtp_array<std::uint16_t>(text, "BoundaryLabels");
  REQUIRE(points.size() == 15);
  CHECK(std::memcmp(points.data(), mesh.positions.data(), 60) == 0);
  CHECK(offsets == std::vector<std::int64_t>{3, 6, 9, 12, 15, 18, 21});
  REQUIRE(corners.size() == 21);
  CHECK(std::vector<std::int64_t>(corners.begin(), corners.begin() + 3) == std::vector<std::int64_t>{0, 1, 2});
  CHECK(labels == std::vector<std::uint16_t>{7, 1, 1, 0, 1, 0, 1, 0, 7, 0, 7, 0, 7, 0});
  // The triangle with outside behind is turned around.
  CHECK(std::vector<std::int64_t>(corners.begin() + 12, corners.begin() + 15) == std::vector<std::int64_t>{1, 4, 0});
}

TEST_CASE("mesh files: plain files of other programs are read") {
  const TemporaryFolder folder;
  const std::map<std::string, std::string> files{
      {"ascii.ply",
       "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nelement vertex 4\r\nproperty double x\r\nproperty double "
       "y\r\n"
       "property double z\r\nproperty uchar red\r\nelement face 1\r\nproperty list uchar int vertex_index\r\n"
       "element edge 1\r\nproperty int vertex1\r\nend_header\r\n0 0 0 1\r\n1 0 0 1\r\n1 1 0 1\r\n0 1 0 9\r\n4 0 1 2 "
       "3\r\n7\r\n"},
      {"ascii.stl",
       "solid vertex of a name\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\n"
       "endfacet\nfacet normal 0 0 1\n outer loop\n vertex -0 0 0\n vertex 1 1 0\n vertex 0 1 0\nendloop\nendfacet\n"
       "endsolid vertex\n"},
      {"plain.obj",
       "# by hand\nmtllib x.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\ng front_door\nf 1/1/1 2//1 3 -1\n"},
      {"plain.off", "OFF 4 1 0\n# by hand\n0 0 0\n1 0 0 255 0 0\n1 1 0\n\n0 1 0\n4 0 1 2 3 0.5 0.5 0.5\n"},
      {"colour.off", "COFF\n4 2 5\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"},
  };
  for (const auto& file : files) {
    INFO(file.first);
    const IndexedMesh mesh = read(folder.write(file.first, file.second));
    CHECK(mesh.positions.size() == 4);
    CHECK(mesh.positions[2] == Eigen::Vector3f(1, 1, 0));
    REQUIRE(mesh.triangles.size() == 2);
    CHECK(mesh.triangles[1] == std::array<std::uint32_t, 3>{0, 2, 3});
    CHECK(mesh.label_front == std::vector<Label>(2, kOutside));
    CHECK(mesh.label_back == std::vector<Label>(2, 1));
  }
}

TEST_CASE("mesh files: a big-endian PLY is read") {
  const TemporaryFolder folder;
  std::string bytes =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar ushort vertex_indices\nend_header\n";
  for (const float value : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 2.5f, 0.f}) {
    char raw[4];
    std::memcpy(raw, &value, 4);
    for (const int k : {3, 2, 1, 0}) bytes += raw[k];
  }
  bytes += std::string("\3\0\0\0\1\0\2", 7);
  const IndexedMesh mesh = read(folder.write("big.ply", bytes));
  CHECK(mesh.positions[2] == Eigen::Vector3f(0, 2.5f, 0));
  CHECK(mesh.triangles == std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}});
}

TEST_CASE("mesh files: broken files have their stated error") {
  const TemporaryFolder folder;
  const std::string ply_head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string face = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  struct Broken {
    std::string file, bytes;
    ErrorCode code;
  };
  const Broken table[] = {
      {"a.ply", "", ErrorCode::parse_failed},
      {"b.ply", "solid", ErrorCode::unsupported_format},
      {"c.ply", "ply\nformat ascii", ErrorCode::parse_failed},
      {"d.ply", ply_head + face + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", ErrorCode::parse_failed},
      {"e.ply", ply_head + face + "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", ErrorCode::parse_failed},
      {"f.ply", ply_head + face + "0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", ErrorCode::non_finite},
      {"g.ply", ply_head + face + "0 0 0\n1 0 0\n0 1 0\n4000000000 0 1", ErrorCode::parse_failed},
      {"h.ply", "ply\nformat ascii 1.0\nelement vertex 4294967295\nend_header\n", ErrorCode::parse_failed},
      {"i.ply", "ply\nformat ascii 1.0\nelement vertex 4294967296\nend_header\n", ErrorCode::too_large},
      {"j.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n0\n", ErrorCode::parse_failed},
      {"k.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nend_header\n12",
       ErrorCode::parse_failed},
      {"l.ply", "ply\nformat morse 1.0\nend_header\n", ErrorCode::unsupported_format},
      {"a.stl", "", ErrorCode::parse_failed},
      {"b.stl", std::string(84, 'x'), ErrorCode::parse_failed},
      {"c.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", ErrorCode::parse_failed},
      {"a.obj", "v 0 0 0\nf 1 2 3\n", ErrorCode::parse_failed},
      {"b.obj", "v 0 0\n", ErrorCode::parse_failed},
      {"c.obj", "v 0 0 0\nf 0 1 1\n", ErrorCode::parse_failed},
      {"d.obj", "v 0 0 0\nf -2 1 1\n", ErrorCode::parse_failed},
      {"e.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\ng front_3_back_3\nf 1 2 3\n", ErrorCode::parse_failed},
      {"a.off", "4 0 0", ErrorCode::unsupported_format},
      {"b.off", "OFF\n3000000000 1 0\n0 0 0\n", ErrorCode::parse_failed},
      {"c.off", "OFF\n1 1 0\n0 0 0\n4000000000 0 0", ErrorCode::parse_failed},
      {"a.gltf", "{}", ErrorCode::unsupported_format},
  };
  for (const Broken& broken : table) {
    INFO(broken.file);
    const auto mesh = read_mesh(folder.write(broken.file, broken.bytes));
    REQUIRE_FALSE(mesh.has_value());
    CHECK_MESSAGE(mesh.error().code == broken.code, mesh.error().message);
    CHECK(mesh.error().message.find('\n') == std::string::npos);
  }
  CHECK(read_mesh(folder.path("none.ply")).error().code == ErrorCode::file_not_found);
  CHECK(write_ply(two_tetrahedra(), folder.path("no/folder/m.ply")).error().code == ErrorCode::io_failed);
  CHECK(write_vtp(two_tetrahedra(), folder.path(".")).error().code == ErrorCode::io_failed);
}

TEST_CASE("mesh files: no cut or harmed PLY or STL crashes the reader") {
  const TemporaryFolder folder;
  const IndexedMesh mesh = two_tetrahedra();
  REQUIRE(write_ply(mesh, folder.path("m.ply")).has_value());
  REQUIRE(write_stl(mesh, folder.path("m.stl")).has_value());
  std::mt19937 random(3);
  int refused = 0;
  for (const char* file : {"m.ply", "m.stl"}) {
    const std::string whole = bytes_of(folder.path(file));
    for (int round = 0; round < 400; ++round) {
      std::string harmed = whole;
      for (int k = 0; k < 1 + round % 4; ++k) harmed[random() % harmed.size()] = static_cast<char>(random());
      if (round % 2) harmed.resize(random() % harmed.size());
      const auto result = read_mesh(folder.write(std::string("x_") + file, harmed));
      refused += !result;
      if (!result) continue;
      for (const auto& triangle : result->triangles)
        for (const std::uint32_t corner : triangle) CHECK(corner < result->positions.size());
    }
  }
  MESSAGE(refused, " of 800 refused");
  CHECK(refused > 400);
}

TEST_CASE("mesh files: an empty mesh can be written and read") {
  const TemporaryFolder folder;
  REQUIRE(write_ply({}, folder.path("m.ply")).has_value());
  REQUIRE(write_stl({}, folder.path("m.stl")).has_value());
  REQUIRE(write_obj({}, folder.path("m.obj")).has_value());
  REQUIRE(write_vtp({}, folder.path("m.vtp")).has_value());
  for (const char* file : {"m.ply", "m.stl", "m.obj"}) CHECK(read(folder.path(file)).triangles.empty());
}
