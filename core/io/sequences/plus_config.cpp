#include "core/io/sequences/plus_config.h"

#include <pugixml.hpp>

#include "core/io/byte_file.h"
#include "core/io/sequences/matrix_text.h"
#include "core/io/text_scanner.h"

namespace sonoloft {
namespace {

Result<PlusTransform> read_transform(const pugi::xml_node& element, const std::string& name) {
  PlusTransform transform{element.attribute("From").value(), element.attribute("To").value(), {}};
  if (transform.from.empty() || transform.to.empty())
    return fail(ErrorCode::parse_failed, name + ": a Transform without From or To: name both");
  const auto matrix =
      parse_matrix(element.attribute("Matrix").value(), name + " " + transform.from + "To" + transform.to);
  if (!matrix) return tl::unexpected(matrix.error());
  transform.matrix = *matrix;
  return transform;
}

Result<std::array<std::uint32_t, 2>> read_pair(const char* text, const std::string& name) {
  TextScanner in(text, name);
  std::array<std::uint32_t, 2> pair;
  for (std::uint32_t& value : pair) value = static_cast<std::uint32_t>(in.whole("a number of pixels", 1u << 16));
  if (in.failed()) return in.failure();
  return pair;
}

/// Nothing where none is stated, or a size of nothing.
Result<std::optional<ClipRectangle>> read_clip(const pugi::xml_node& element, const std::string& name) {
  const auto origin = element.attribute("ClipRectangleOrigin"), size = element.attribute("ClipRectangleSize");
  if (!origin || !size) return std::optional<ClipRectangle>();
  const auto from = read_pair(origin.value(), name + " ClipRectangleOrigin");
  if (!from) return tl::unexpected(from.error());
  const auto sides = read_pair(size.value(), name + " ClipRectangleSize");
  if (!sides) return tl::unexpected(sides.error());
  if ((*sides)[0] == 0 || (*sides)[1] == 0) return std::optional<ClipRectangle>();
  return ClipRectangle{*from, *sides};
}

}  // namespace

Result<PlusConfig> parse_plus_config(std::string_view text, std::string_view text_name) {
  const std::string name(text_name);
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  if (!parsed)
    return fail(ErrorCode::unsupported_format, name + ": no XML, " + parsed.description() + " at byte " +
                                                   std::to_string(parsed.offset) + ": mend it there");
  const pugi::xml_node root = document.child("PlusConfiguration");
  if (!root)
    return fail(ErrorCode::unsupported_format, name + ": no PlusConfiguration: give the configuration of PLUS");
  PlusConfig config;
  for (const pugi::xml_node& element : root.child("CoordinateDefinitions").children("Transform")) {
    auto transform = read_transform(element, name);
    if (!transform) return tl::unexpected(transform.error());
    config.transforms.push_back(std::move(*transform));
  }
  auto clip = read_clip(root.child("VolumeReconstruction"), name);
  if (!clip) return tl::unexpected(clip.error());
  config.clip = *clip;
  return config;
}

Result<PlusConfig> read_plus_config(const std::filesystem::path& path) {
  const auto text = read_bytes(path);
  if (!text) return tl::unexpected(text.error());
  return parse_plus_config(*text, path.filename().string());
}

}  // namespace sonoloft
