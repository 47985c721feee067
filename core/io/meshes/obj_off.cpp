#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/io/byte_file.h"
#include "core/io/meshes/mesh_builder.h"
#include "core/io/meshes/mesh_files.h"
#include "core/io/meshes/mesh_labels.h"
#include "core/io/meshes/mesh_parsers.h"
#include "core/io/text_scanner.h"

namespace sonoloft {
namespace {

/// The lines of a text without comments and blank lines.
class Lines {
 public:
  Lines(std::string_view text, std::string name) : text_(text), name_(std::move(name)) {}

  /// False at the end of the text.
  bool next() {
    while (!text_.empty()) {
      const std::size_t end = std::min(text_.find('\n'), text_.size());
      const std::string_view line = text_.substr(0, std::min(text_.find('#'), end));
      text_.remove_prefix(std::min(end + 1, text_.size()));
      ++number_;
      current_ = TextScanner(line, name_, number_);
      if (!current_.at_end()) return true;
    }
    current_ = TextScanner({}, name_, number_);
    return false;
  }

  TextScanner& current() { return current_; }
  std::size_t bytes_left() const { return text_.size(); }

 private:
  std::string_view text_;
  std::string name_;
  std::size_t number_ = 0;
  TextScanner current_{{}, {}};
};

/// `7`, `7/1`, `7//3` or `-1`: counted from 1, or backwards from the last.
std::uint32_t obj_corner(TextScanner& in, std::uint32_t position_count) {
  std::string_view word = in.word("a corner");
  word = word.substr(0, word.find('/'));
  const bool from_end = word.starts_with('-');
  if (from_end) word.remove_prefix(1);
  const std::uint64_t number = in.whole_from(word, "a corner", 0xFFFFFFFE, ErrorCode::parse_failed);
  if (number == 0 || (from_end && number > position_count))
    in.set_error(ErrorCode::parse_failed, "a corner names a vertex that is not there: mend the face");
  return in.failed() ? 0 : static_cast<std::uint32_t>(from_end ? position_count - number : number - 1);
}

/// `front_F_back_B` as write_obj names its groups; any other group is a plain mesh.
void set_labels_from_group(std::string_view group, MeshBuilder& mesh) {
  constexpr std::string_view kFront = "front_", kBack = "_back_";
  mesh.set_labels(kOutside, 1);
  const std::size_t middle = group.find(kBack);
  if (!group.starts_with(kFront) || middle == std::string_view::npos) return;
  TextScanner numbers({}, {});
  const auto label = [&](std::string_view digits) {
    return static_cast<Label>(numbers.whole_from(digits, "a label", kMaxLabel, ErrorCode::parse_failed));
  };
  const Label front = label(group.substr(kFront.size(), middle - kFront.size()));
  const Label back = label(group.substr(middle + kBack.size()));
  if (!numbers.failed()) mesh.set_labels(front, back);
}

void append_number(std::string& out, float value) {
  char digits[32];
  out.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

void append_vertex(std::string& out, const Eigen::Vector3f& p) {
  out += 'v';
  for (const float c : {p.x(), p.y(), p.z()}) {
    out += ' ';
    append_number(out, c);
  }
  out += '\n';
}

/// What the labels' materials are called: by the labels' names, and their numbers where two have one name.
std::map<Label, std::string> material_names(const IndexedMesh& mesh, const LabelTable& labels) {
  std::map<Label, std::string> names;
  std::set<std::string> taken;
  for (const Label label : materials_of(mesh)) {
    std::string name = labels.name(label);
    std::replace(name.begin(), name.end(), ' ', '_');
    while (!taken.insert(name).second) name += '_' + std::to_string(label);
    names.emplace(label, std::move(name));
  }
  return names;
}

std::string material_file(const std::map<Label, std::string>& names, const LabelTable& labels) {
  std::string out = "# SonoLoft\n";
  for (const auto& [label, name] : names) {
    out += "newmtl " + name + "\nKd";
    for (const std::uint8_t channel : labels.colour(label)) {
      out += ' ';
      append_number(out, static_cast<float>(channel) / 255);
    }
    out += '\n';
  }
  return out;
}

}  // namespace

Result<IndexedMesh> parse_obj(std::string_view text, const std::string& name) {
  Lines lines(text, name);
  MeshBuilder mesh;
  std::vector<std::uint32_t> corners;
  while (lines.next()) {
    TextScanner& in = lines.current();
    const std::string_view word = in.word("a statement");
    if (word == "v") {
      mesh.add_position(in.vector("a coordinate"));
    } else if (word == "f") {
      corners.clear();
      while (!in.failed() && !in.at_end()) corners.push_back(obj_corner(in, mesh.position_count()));
      mesh.add_polygon(corners);
    } else if (word == "g") {
      set_labels_from_group(in.at_end() ? std::string_view() : in.word("a group"), mesh);
    }
    if (in.failed()) return in.failure();
  }
  return std::move(mesh).finish(name);
}

Result<IndexedMesh> parse_off(std::string_view text, const std::string& name) {
  Lines lines(text, name);
  lines.next();
  if (!lines.current().word("OFF").ends_with("OFF"))
    return fail(ErrorCode::unsupported_format, name + ": does not begin with OFF: not an OFF file");
  if (lines.current().at_end()) lines.next();
  const std::uint64_t position_count = lines.current().whole("the number of vertices", 0xFFFFFFFE);
  const std::uint64_t face_count = lines.current().whole("the number of faces", 0xFFFFFFFE);
  if (lines.current().failed()) return lines.current().failure();

  MeshBuilder mesh;
  for (std::uint64_t i = 0; i < position_count; ++i) {
    lines.next();
    mesh.add_position(lines.current().vector("a coordinate"));  // normals or colours may follow
    if (lines.current().failed()) return lines.current().failure();
  }
  std::vector<std::uint32_t> corners;
  for (std::uint64_t i = 0; i < face_count; ++i) {
    lines.next();
    TextScanner& in = lines.current();
    const std::uint64_t count = in.whole("a number of corners", 0xFFFFFFFF);
    corners.clear();
    for (std::uint64_t k = 0; k < count && !in.failed(); ++k)
      corners.push_back(static_cast<std::uint32_t>(in.whole("a corner", 0xFFFFFFFE, ErrorCode::parse_failed)));
    if (in.failed()) return in.failure();
    mesh.add_polygon(corners);
  }
  return std::move(mesh).finish(name);
}

Result<void> write_obj(const IndexedMesh& mesh, const std::filesystem::path& path, const LabelTable& labels) {
  const auto materials = material_names(mesh, labels);
  const std::filesystem::path material_path = std::filesystem::path(path).replace_extension(".mtl");
  std::string out = "# SonoLoft; millimetres\n# SPACE=LPS\nmtllib " + material_path.filename().string() + '\n';
  // MeshLab 2020.09 loses every triangle that uses the first vertex, then aborts: so no triangle uses it.
  if (!mesh.positions.empty()) append_vertex(out, mesh.positions.front());
  for (const Eigen::Vector3f& p : mesh.positions) append_vertex(out, p);
  std::map<std::pair<Label, Label>, std::vector<std::size_t>> groups;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    groups[{mesh.label_front[t], mesh.label_back[t]}].push_back(t);
  for (const auto& [sides, triangles] : groups) {
    const auto [front, back] = sides;
    out += "g front_" + std::to_string(front) + "_back_" + std::to_string(back) + "\nusemtl " +
           materials.at(shown_label(front, back)) + '\n';
    for (const std::size_t t : triangles) {
      out += 'f';
      for (const std::uint32_t corner : mesh.triangles[t]) out += ' ' + std::to_string(std::uint64_t{corner} + 2);
      out += '\n';
    }
  }
  if (auto written = write_bytes(material_path, material_file(materials, labels)); !written) return written;
  return write_bytes(path, out);
}

}  // namespace sonoloft
