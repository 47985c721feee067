#include "core/io/labels/label_table.h"

#include <doctest/doctest.h>

#include <cmath>
#include <set>

using namespace sonoloft;

namespace {

LabelTable parsed(const std::string& text) {
  auto table = parse_label_table(text, "t.ctbl");
  REQUIRE_MESSAGE(table, (table ? "" : table.error().message));
  return *table;
}

Error refusal(const std::string& text) {
  const auto table = parse_label_table(text, "t.ctbl");
  REQUIRE_FALSE(table);
  CHECK(table.error().message.starts_with("t.ctbl:"));
  return table.error();
}

}  // namespace

TEST_CASE("label table: a colour table of Slicer gives names and colours, all others are numbers") {
  const LabelTable table = parsed(
      "# Color table file liver.ctbl\r\n# 4 values\r\n0 Background 0 0 0 0\r\n1 liver 216 101 79 255\r\n"
      "\n3 portal_vein_\xc3\xa4 1 2 3\n65520 last 255 255 255 0");
  CHECK(table.name(0) == "Background");
  CHECK(table.name(1) == "liver");
  CHECK(table.colour(1) == Rgb{216, 101, 79});
  CHECK(table.name(3) == "portal vein \xc3\xa4");
  CHECK(table.colour(3) == Rgb{1, 2, 3});
  CHECK(table.name(kMaxLabel) == "last");
  CHECK(table.name(2) == "label 2");
  CHECK(table.colour(2) == label_colour(2));
  CHECK(LabelTable().name(7) == "label 7");
  CHECK(parsed("").colour(7) == label_colour(7));
}

TEST_CASE("label table: a bad line is named with its number") {
  const struct {
    const char* line;
    ErrorCode code;
  } bad[] = {{"one liver 1 2 3", ErrorCode::parse_failed},      {"1 liver 1 2", ErrorCode::parse_failed},
             {"1 liver 1 2 256", ErrorCode::parse_failed},      {"1 liver 1 2 -3", ErrorCode::parse_failed},
             {"1 liver 0.1 0.2 0.3", ErrorCode::parse_failed},  {"1 left liver 1 2 3", ErrorCode::parse_failed},
             {"1 liver 1 2 3 255 4", ErrorCode::parse_failed},  {"1 liver 1 2 3 999", ErrorCode::parse_failed},
             {"5 again 1 2 3 255", ErrorCode::parse_failed},    {"65521 unknown 1 2 3", ErrorCode::bad_contour},
             {"1 li\x07ver 1 2 3", ErrorCode::parse_failed},    {"1 li\xffver 1 2 3", ErrorCode::parse_failed},
             {"1 liver\xc3 1 2 3", ErrorCode::parse_failed},    {"1 \xc0\xafliver 1 2 3", ErrorCode::parse_failed},
             {"1 \xed\xa0\x80 1 2 3", ErrorCode::parse_failed}, {"1 \xc2\x85 1 2 3", ErrorCode::parse_failed}};
  for (const auto& wrong : bad) {
    INFO(wrong.line);
    const Error error = refusal("# a comment\n\n5 tumour 1 2 3 255\n" + std::string(wrong.line) + "\n6 skin 1 2 3\n");
    CHECK(error.message.starts_with("t.ctbl:4: "));
    CHECK(error.code == wrong.code);
  }
  CHECK(read_label_table("nowhere.ctbl").error().code == ErrorCode::file_not_found);
}

TEST_CASE("label colours: the first 24 labels are told apart, grey means outside") {
  std::set<Rgb> seen{label_colour(kOutside)};
  int nearest = 1000;
  for (Label label = 1; label <= 24; ++label) {
    const auto colour = label_colour(label);
    for (const auto& other : seen)
      nearest = std::min(
          nearest, std::abs(colour[0] - other[0]) + std::abs(colour[1] - other[1]) + std::abs(colour[2] - other[2]));
    seen.insert(colour);
  }
  MESSAGE("nearest two of 25 colours: ", nearest, " of 765");
  CHECK(nearest >= 50);
}
