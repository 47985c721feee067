#include "core/io/sequences/plus_config.h"

#include <doctest/doctest.h>

using namespace sonoloft;

namespace {

std::string config(const std::string& transform, const std::string& reconstruction = "") {
  return "<PlusConfiguration version=\"2.1\">\n<!-- a comment --><CoordinateDefinitions>" + transform +
         "</CoordinateDefinitions>\n<VolumeReconstruction " + reconstruction + "/></PlusConfiguration>\n";
}

const std::string kProbe =
    "<Transform From=\"Image\" To=\"Probe\" Matrix=\"\n 0.1 0 0 5\n\t0 0 0.2 6\n 0 -0.3 0 7\n 0 0 0 1\" "
    "Error=\"0.5\"/>";

ErrorCode refusal(const std::string& text) {
  const auto read = parse_plus_config(text, "c.xml");
  REQUIRE_FALSE(read);
  CHECK(read.error().message.starts_with("c.xml"));
  return read.error().code;
}

}  // namespace

TEST_CASE("PLUS configuration: transforms and the clip rectangle are read") {
  const auto read = parse_plus_config(
      config(kProbe, "OutputSpacing=\"1 1 1\" ClipRectangleOrigin=\"10 20\" ClipRectangleSize=\"300 200\""), "c.xml");
  REQUIRE(read);
  REQUIRE(read->transforms.size() == 1);
  CHECK(read->transforms[0].from == "Image");
  CHECK(read->transforms[0].to == "Probe");
  CHECK((read->transforms[0].matrix * Eigen::Vector3d(10, 20, 0)).isApprox(Eigen::Vector3d(6, 6, 1)));
  REQUIRE(read->clip);
  CHECK(read->clip->origin == std::array<std::uint32_t, 2>{10, 20});
  CHECK(read->clip->size == std::array<std::uint32_t, 2>{300, 200});
  const auto bare = parse_plus_config("<PlusConfiguration/>", "c.xml");
  REQUIRE(bare);
  CHECK(bare->transforms.empty());
  CHECK_FALSE(bare->clip);
  CHECK_FALSE(parse_plus_config(config("", "ClipRectangleOrigin=\"0 0\" ClipRectangleSize=\"0 0\""), "")->clip);
}

TEST_CASE("PLUS configuration: what is none, or is broken, is refused with the reason") {
  CHECK(refusal("ObjectType = Image") == ErrorCode::unsupported_format);
  CHECK(refusal("<PlusConfiguration>") == ErrorCode::unsupported_format);
  CHECK(refusal("<Other/>") == ErrorCode::unsupported_format);
  CHECK(refusal(config("<Transform From=\"Image\" Matrix=\"1\"/>")) == ErrorCode::parse_failed);
  CHECK(refusal(config("<Transform From=\"Image\" To=\"Probe\"/>")) == ErrorCode::parse_failed);
  CHECK(refusal(config("<Transform From=\"A\" To=\"B\" Matrix=\"1 0 0 0 0 1 0 0 0 0 0 0 0 0 0 1\"/>")) ==
        ErrorCode::parse_failed);
  CHECK(refusal(config("", "ClipRectangleOrigin=\"-1 0\" ClipRectangleSize=\"1 1\"")) == ErrorCode::parse_failed);
  CHECK(read_plus_config("nowhere.xml").error().code == ErrorCode::file_not_found);
}
