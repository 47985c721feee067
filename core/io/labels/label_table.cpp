#include "core/io/labels/label_table.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/io/byte_file.h"
#include "core/io/text_scanner.h"

namespace sonoloft {
namespace {

/// Whether it is UTF-8 without control characters: names go into files of many kinds.
bool is_printable(std::string_view text) {
  constexpr char32_t kLowest[] = {0x20, 0, 0x80, 0x800, 0x10000};  // by the number of ones that the first byte leads
  while (!text.empty()) {
    const auto first = static_cast<std::uint8_t>(text[0]);
    const auto ones = static_cast<std::size_t>(std::countl_one(first));
    const std::size_t bytes = std::max<std::size_t>(ones, 1);
    if (ones == 1 || ones > 4 || bytes > text.size()) return false;
    char32_t code = first & (0xFFu >> (ones + 1));
    if (ones == 0) code = first;
    for (std::size_t i = 1; i < bytes; ++i) {
      if (std::countl_one(static_cast<std::uint8_t>(text[i])) != 1) return false;
      code = code << 6 | (static_cast<std::uint8_t>(text[i]) & 0x3Fu);
    }
    const bool control = code == 0x7F || (code >= 0x80 && code < 0xA0), surrogate = code >= 0xD800 && code < 0xE000;
    if (code < kLowest[ones] || code > 0x10FFFF || control || surrogate) return false;
    text.remove_prefix(bytes);
  }
  return true;
}

/// One line that is no comment.
void read_label(TextScanner& in, LabelTable& table) {
  const auto label = static_cast<Label>(in.whole("the label", kMaxLabel, ErrorCode::bad_contour));
  std::string name(in.word("the name"));
  std::replace(name.begin(), name.end(), '_', ' ');
  Rgb colour;
  for (std::uint8_t& channel : colour)
    channel = static_cast<std::uint8_t>(in.whole("a share of the colour", 255, ErrorCode::parse_failed));
  if (!in.failed() && !in.at_end()) (void)in.whole("the opacity", 255, ErrorCode::parse_failed);
  if (in.failed()) return;
  if (!in.at_end())
    in.set_error(ErrorCode::parse_failed, "more than label, name, red, green, blue and opacity: write _ for a blank");
  else if (!is_printable(name))
    in.set_error(ErrorCode::parse_failed, "the name is no UTF-8 text: save the file as UTF-8");
  else if (!table.add(label, std::move(name), colour))
    in.set_error(ErrorCode::parse_failed, "label " + std::to_string(label) + " was stated before: remove one line");
}

}  // namespace

std::string LabelTable::name(Label label) const {
  const auto entry = entries_.find(label);
  return entry != entries_.end() ? entry->second.name : "label " + std::to_string(label);
}

Rgb LabelTable::colour(Label label) const {
  const auto entry = entries_.find(label);
  return entry != entries_.end() ? entry->second.colour : label_colour(label);
}

bool LabelTable::add(Label label, std::string name, const Rgb& colour) {
  return entries_.try_emplace(label, Entry{std::move(name), colour}).second;
}

Result<LabelTable> parse_label_table(std::string_view text, std::string_view name) {
  LabelTable table;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    TextScanner in(line, name, number);
    if (line.starts_with('#') || in.at_end()) continue;
    read_label(in, table);
    if (in.failed()) return in.failure();
  }
  return table;
}

Result<LabelTable> read_label_table(const std::filesystem::path& path) {
  const auto text = read_bytes(path);
  if (!text) return tl::unexpected(text.error());
  return parse_label_table(*text, path.filename().string());
}

}  // namespace sonoloft
