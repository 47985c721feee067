#include <string>
#include <vector>

#include "core/io/byte_file.h"
#include "core/io/byte_order.h"
#include "core/io/meshes/mesh_builder.h"
#include "core/io/meshes/mesh_files.h"
#include "core/io/meshes/mesh_labels.h"
#include "core/io/meshes/mesh_parsers.h"
#include "core/io/text_scanner.h"

namespace sonoloft {
namespace {

struct Type {
  std::string_view name, other_name;
  std::size_t size;
  double (*load)(std::string_view bytes, std::size_t offset, std::endian order);
};

template <class T>
double load_as(std::string_view bytes, std::size_t offset, std::endian order) {
  return static_cast<double>(load<T>(bytes, offset, order));
}

constexpr Type kTypes[] = {
    {"char", "int8", 1, load_as<std::int8_t>},    {"uchar", "uint8", 1, load_as<std::uint8_t>},
    {"short", "int16", 2, load_as<std::int16_t>}, {"ushort", "uint16", 2, load_as<std::uint16_t>},
    {"int", "int32", 4, load_as<std::int32_t>},   {"uint", "uint32", 4, load_as<std::uint32_t>},
    {"float", "float32", 4, load_as<float>},      {"double", "float64", 8, load_as<double>},
};

struct Property {
  std::string_view name;
  const Type* type;
  const Type* count_type;  ///< of a list, else null
};

struct Element {
  std::string_view name;
  std::uint64_t count;
  std::vector<Property> properties;
};

enum class Coding { ascii, little, big };

struct Header {
  Coding coding = Coding::ascii;
  std::vector<Element> elements;
};

const Type* read_type(TextScanner& in) {
  const std::string_view name = in.word("a type");
  for (const Type& type : kTypes)
    if (name == type.name || name == type.other_name) return &type;
  in.set_error(ErrorCode::parse_failed, "unknown type of a property: mend the header");
  return &kTypes[0];
}

Coding read_coding(TextScanner& in) {
  const std::string_view coding = in.word("the format");
  (void)in.word("the version");
  if (coding == "binary_little_endian") return Coding::little;
  if (coding == "binary_big_endian") return Coding::big;
  if (coding != "ascii") in.set_error(ErrorCode::unsupported_format, "unknown PLY format: write it as ascii or binary");
  return Coding::ascii;
}

Property read_property(TextScanner& in) {
  Property property{};
  TextScanner behind_list = in;
  if (behind_list.word("a property") == "list") {
    in = behind_list;
    property.count_type = read_type(in);
  }
  property.type = read_type(in);
  property.name = in.word("a property's name");
  return property;
}

/// Reads up to and with `end_header`.
Header read_header(TextScanner& in) {
  Header header;
  if (in.word("ply") != "ply") in.set_error(ErrorCode::unsupported_format, "does not begin with ply: not a PLY file");
  while (!in.failed()) {
    const std::string_view word = in.word("end_header");
    if (word == "end_header") break;
    if (word == "comment" || word == "obj_info") {
      in.skip_line();
    } else if (word == "format") {
      header.coding = read_coding(in);
    } else if (word == "element") {
      const std::string_view name = in.word("an element's name");
      header.elements.push_back({name, in.whole("an element's count", 0xFFFFFFFF), {}});
    } else if (word == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(read_property(in));
    } else {
      in.set_error(ErrorCode::parse_failed, "unknown word in the header: mend the header");
    }
  }
  in.skip_line();
  return header;
}

/// The numbers behind the header, one after the other.
class Body {
 public:
  Body(TextScanner& in, std::string_view bytes, Coding coding)
      : in_(in), bytes_(bytes), offset_(in.offset()), coding_(coding) {}

  double next(const Type& type) {
    if (coding_ == Coding::ascii) return in_.real("a value");
    if (bytes_.size() - offset_ < type.size) {
      in_.set_error(ErrorCode::parse_failed, "the file ends within its elements: it is truncated");
      return 0;
    }
    const std::size_t at = std::exchange(offset_, offset_ + type.size);
    return type.load(bytes_, at, coding_ == Coding::big ? std::endian::big : std::endian::little);
  }

  /// A whole number; what is none, or out of range, is the highest.
  std::uint32_t next_whole(const Type& type) {
    const double value = next(type);
    return value >= 0 && value < 4294967295.0 ? static_cast<std::uint32_t>(value) : 0xFFFFFFFF;
  }

 private:
  TextScanner& in_;
  std::string_view bytes_;
  std::size_t offset_;
  Coding coding_;
};

Label to_label(double value) {
  return value >= 0 && value <= kMaxLabel ? static_cast<Label>(value) : kUnknown;
}

/// What a mesh needs of an item; the rest is read over.
struct Item {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  std::vector<std::uint32_t> corners;
  Label front = kOutside, back = 1;
};

void read_value(const Property& property, Body& body, const TextScanner& in, Item& item) {
  if (property.count_type != nullptr) {
    const bool is_face = property.name == "vertex_indices" || property.name == "vertex_index";
    const std::uint32_t count = body.next_whole(*property.count_type);
    for (std::uint32_t k = 0; k < count && !in.failed(); ++k) {
      const std::uint32_t corner = body.next_whole(*property.type);
      if (is_face) item.corners.push_back(corner);
    }
    return;
  }
  const double value = body.next(*property.type);
  if (property.name == "x") item.position.x() = value;
  if (property.name == "y") item.position.y() = value;
  if (property.name == "z") item.position.z() = value;
  if (property.name == "label_front") item.front = to_label(value);
  if (property.name == "label_back") item.back = to_label(value);
}

void read_element(const Element& element, Body& body, TextScanner& in, MeshBuilder& mesh) {
  if (element.properties.empty() && element.count > 0)
    in.set_error(ErrorCode::parse_failed, "an element without properties: mend the header");
  Item item;
  for (std::uint64_t i = 0; i < element.count && !in.failed(); ++i) {
    item.corners.clear();
    for (const Property& property : element.properties) read_value(property, body, in, item);
    if (in.failed()) return;
    if (element.name == "vertex") mesh.add_position(item.position);
    if (element.name == "face") {
      mesh.set_labels(item.front, item.back);
      mesh.add_polygon(item.corners);
    }
  }
}

}  // namespace

Result<IndexedMesh> parse_ply(std::string_view bytes, const std::string& name) {
  TextScanner in(bytes, name);
  const Header header = read_header(in);
  Body body(in, bytes, header.coding);
  MeshBuilder mesh;
  for (const Element& element : header.elements) read_element(element, body, in, mesh);
  if (in.failed()) return in.failure();
  return std::move(mesh).finish(name);
}

Result<void> write_ply(const IndexedMesh& mesh, const std::filesystem::path& path, const LabelTable& labels,
                       const VertexProperties& properties) {
  std::string out = "ply\nformat binary_little_endian 1.0\ncomment SPACE=LPS\ncomment millimetres\n";
  for (const Label label : materials_of(mesh)) {
    out += "comment label " + std::to_string(label) + ' ';
    for (const std::uint8_t channel : labels.colour(label)) out += std::to_string(channel) + ' ';
    out += labels.name(label) + '\n';
  }
  out += "element vertex " + std::to_string(mesh.positions.size()) +
         "\nproperty float x\nproperty float y\nproperty float z\n" +
         (properties.measured.empty() ? "" : "property float measured\n") +
         (properties.distance_mm.empty() ? "" : "property float distance_mm\n") + "element face " +
         std::to_string(mesh.triangles.size()) +
         "\nproperty list uchar int vertex_indices\nproperty ushort label_front\nproperty ushort label_back\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  out.reserve(out.size() + 12 * mesh.positions.size() + 20 * mesh.triangles.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    for (const float c : mesh.positions[v]) append(out, c);
    if (!properties.measured.empty()) append(out, properties.measured[v]);
    if (!properties.distance_mm.empty()) append(out, properties.distance_mm[v]);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    append(out, std::uint8_t{3});
    for (const std::uint32_t corner : mesh.triangles[t]) append(out, corner);
    append(out, mesh.label_front[t]);
    append(out, mesh.label_back[t]);
    for (const std::uint8_t channel : labels.colour(shown_label(mesh.label_front[t], mesh.label_back[t])))
      append(out, channel);
  }
  return write_bytes(path, out);
}

}  // namespace sonoloft
