#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/io/byte_file.h"
#include "core/io/byte_order.h"
#include "core/io/meshes/mesh_files.h"
#include "core/io/meshes/mesh_labels.h"

namespace sonoloft {
namespace {

std::string base64(std::string_view bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return i + k < bytes.size() ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i + k])) : 0u;
    };
    const std::uint32_t group = (byte(0) << 16) | (byte(1) << 8) | byte(2);
    for (std::size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? kDigits[(group >> (18 - 6 * k)) & 63] : '=';
  }
  return out;
}

/// Arrays are written where they are declared and held back until the end of the file.
class AppendedArrays {
 public:
  /// The tag of an array; `attributes` are its type, name and number of components.
  std::string add(const std::string& attributes, const std::string& bytes) {
    std::string block;
    append(block, static_cast<std::uint64_t>(bytes.size()));
    block += bytes;
    std::string tag =
        "<DataArray " + attributes + " format=\"appended\" offset=\"" + std::to_string(data_.size()) + "\"/>\n";
    data_ += base64(block);
    return tag;
  }
  const std::string& data() const { return data_; }

 private:
  std::string data_;
};

struct PolyData {
  std::string points, connectivity, offsets, labels;
};

PolyData poly_data(const IndexedMesh& mesh) {
  PolyData out;
  for (const Eigen::Vector3f& p : mesh.positions)
    for (const float c : {p.x(), p.y(), p.z()}) append(out.points, c);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    auto [a, b, c] = mesh.triangles[t];
    Label from = mesh.label_back[t], to = mesh.label_front[t];
    if (from == kOutside) {
      std::swap(from, to);
      std::swap(b, c);
    }
    for (const std::uint32_t corner : {a, b, c}) append(out.connectivity, static_cast<std::int64_t>(corner));
    append(out.offsets, static_cast<std::int64_t>(3 * (t + 1)));
    append(out.labels, from);
    append(out.labels, to);
  }
  return out;
}

/// A string array holds the codes of its characters and a 0 behind each string.
std::string string_array(const std::string& name, std::span<const std::string> strings) {
  std::string tag = "<DataArray type=\"String\" Name=\"" + name + "\" NumberOfTuples=\"" +
                    std::to_string(strings.size()) + "\" format=\"ascii\">";
  for (const std::string& string : strings) {
    for (const char letter : string) tag += std::to_string(static_cast<unsigned char>(letter)) + ' ';
    tag += "0 ";
  }
  return tag + "</DataArray>\n";
}

std::string field_data(const IndexedMesh& mesh, const LabelTable& labels, AppendedArrays& arrays) {
  std::vector<std::string> names;
  std::string values, colours;
  for (const Label label : materials_of(mesh)) {
    names.push_back(labels.name(label));
    append(values, label);
    for (const std::uint8_t channel : labels.colour(label)) append(colours, channel);
  }
  const std::string tuples = "NumberOfTuples=\"" + std::to_string(names.size()) + '"';
  return "<FieldData>\n" + string_array("SPACE", std::array<std::string, 1>{"LPS"}) +
         arrays.add("type=\"UInt16\" Name=\"LabelValues\" " + tuples, values) + string_array("LabelNames", names) +
         arrays.add("type=\"UInt8\" Name=\"LabelColors\" NumberOfComponents=\"3\" " + tuples, colours) +
         "</FieldData>\n";
}

}  // namespace

Result<void> write_vtp(const IndexedMesh& mesh, const std::filesystem::path& path, const LabelTable& labels) {
  const PolyData data = poly_data(mesh);
  AppendedArrays arrays;
  std::string out =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n";
  out += field_data(mesh, labels, arrays);
  out += "<Piece NumberOfPoints=\"" + std::to_string(mesh.positions.size()) + "\" NumberOfPolys=\"" +
         std::to_string(mesh.triangles.size()) + "\">\n";
  out += "<CellData>\n" + arrays.add("type=\"UInt16\" Name=\"BoundaryLabels\" NumberOfComponents=\"2\"", data.labels) +
         "</CellData>\n";
  out += "<Points>\n" + arrays.add("type=\"Float32\" Name=\"Points\" NumberOfComponents=\"3\"", data.points) +
         "</Points>\n";
  out += "<Polys>\n" + arrays.add("type=\"Int64\" Name=\"connectivity\"", data.connectivity) +
         arrays.add("type=\"Int64\" Name=\"offsets\"", data.offsets) + "</Polys>\n";
  out += "</Piece>\n</PolyData>\n<AppendedData encoding=\"base64\">\n_" + arrays.data() +
         "\n</AppendedData>\n</VTKFile>\n";
  return write_bytes(path, out);
}

}  // namespace sonoloft
