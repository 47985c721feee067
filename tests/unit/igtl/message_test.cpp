#include "host/igtl/wire/message.h"

#include <doctest/doctest.h>

#include <cstring>

#include "host/igtl/wire/message_bodies.h"
#include "tests/unit/igtl/igtl_client.h"

using namespace sonoloft;
using namespace sonoloft::test;
using namespace std::chrono_literals;

TEST_CASE(
    "message: version 1 is header and body, version 2 has an extended header and empty metadata around the body") {
  const igtl::Message sent{"TRANSFORM",
                           "a name of 20 bytes..",
                           std::chrono::system_clock::time_point(5s + 500ms),
                           {std::byte{1}, std::byte{2}, std::byte{3}}};
  for (const int version : {1, 2}) {
    CAPTURE(version);
    const Bytes bytes = igtl::framed(sent, version);
    CHECK(bytes.size() == (version == 1 ? 58u + 3 : 58u + 12 + 3 + 2));
    std::size_t size = 0;
    const auto received = parse(bytes, size);
    REQUIRE(received);
    CHECK(size == bytes.size());
    CHECK(received->version == version);
    CHECK(received->type == "TRANSFORM");
    CHECK(received->device == "a name of 20 bytes..");
    CHECK((received->timestamp + 8) / 16 == 0x5800'0000ull);  // the library rounds down
    CHECK(received->content == sent.body);
  }
}

TEST_CASE("message: the check sum is ECMA's CRC-64, and may be taken in parts") {
  const char* const text = "123456789";
  const auto* const bytes = reinterpret_cast<const std::byte*>(text);
  CHECK(igtl::crc(bytes, 9) == 0x6C40DF5F0B497347ull);
  CHECK(igtl::crc(bytes + 4, 5, igtl::crc(bytes, 4)) == 0x6C40DF5F0B497347ull);
}

TEST_CASE("message: POLYDATA has the points, the triangles and the label of every point") {
  const igtl::LabelSurface surface{7, {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {-1, 0, 0.5f}}, {{0, 1, 2}, {3, 2, 1}}};
  const Polydata data = polydata(igtl::polydata_body(surface));
  CHECK(data.points == surface.points);
  CHECK(data.triangles == surface.triangles);
  CHECK(data.scalars == "Label");
  CHECK(data.values == std::vector<float>(4, 7));
}

TEST_CASE("message: POLYDATA of a label that is gone is a point") {
  const Polydata data = polydata(igtl::polydata_body({9, {{1, 2, 3}}, {}}));
  CHECK(data.points.size() == 1);
  CHECK(data.triangles.empty());
  CHECK(data.values == std::vector<float>{9});
}

TEST_CASE("message: TRANSFORM and TDATA have the matrix column by column, STATUS a code and a text") {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  pose.translation() << 10, 20, 30;
  const std::array<float, 12> columns{0, 1, 0, -1, 0, 0, 0, 0, 1, 10, 20, 30};
  const Bytes transform = igtl::transform_body(pose), tdata = igtl::tdata_body("probe", pose);
  REQUIRE(transform.size() == 48);
  REQUIRE(tdata.size() == 70);
  CHECK(std::strcmp(reinterpret_cast<const char*>(tdata.data()), "probe") == 0);
  CHECK(tdata[20] == std::byte{2});  // six degrees of freedom
  for (std::size_t i = 0; i < 12; ++i) {
    CHECK(big_endian_float(transform, 4 * i) == columns[i]);
    CHECK(big_endian_float(tdata, 22 + 4 * i) == columns[i]);
  }
  const Bytes status = igtl::status_body("fine");
  REQUIRE(status.size() == 35);
  CHECK(big_endian(status, 0, 2) == 1);
  CHECK(std::strcmp(reinterpret_cast<const char*>(status.data() + 30), "fine") == 0);
}

TEST_CASE("message: STT_TDATA says how often, never less than at once") {
  Bytes asked;
  append_big_endian(asked, 50, 4);
  asked.resize(36);
  CHECK(igtl::tdata_interval(asked) == 50ms);
  asked[0] = std::byte{0xFF};
  CHECK(igtl::tdata_interval(asked) == 0ms);
  asked.pop_back();
  CHECK(!igtl::tdata_interval(asked));
}
