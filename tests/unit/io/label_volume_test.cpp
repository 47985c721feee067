#include "core/io/volumes/label_volume.h"

#include <doctest/doctest.h>
#include <zlib.h>

#include <string>

#include "tests/support/temporary_folder.h"

using namespace sonoloft;

namespace {

std::string header(const std::string& lines, std::size_t size = 256) {
  std::string text = "#INRIMAGE-4#{\n" + lines;
  text.resize(size - 4, '\n');
  return text + "##}\n";
}

const std::string k2x3x4 = "XDIM=2\nYDIM=3\nZDIM=4\nVDIM=1\nVX=0.5\nVY=0.25\nVZ=1.5\nTYPE=unsigned fixed\n";

std::string counting_bytes(int count) {
  std::string bytes;
  for (int k = 0; k < count; ++k) bytes += static_cast<char>(k);
  return bytes;
}

}  // namespace

TEST_CASE("label volume: 8 bits, x fastest, with spacing and origin") {
  const test::TemporaryFolder folder;
  const std::string text = header(k2x3x4 + "TX=10\nPIXSIZE=8 bits\nCPU=decm\n", 512) + counting_bytes(24);
  const auto volume = read_inr(folder.write("v.inr", text));
  REQUIRE(volume.has_value());
  CHECK(volume->dims == std::array<std::uint32_t, 3>{2, 3, 4});
  CHECK(volume->spacing_mm == Eigen::Vector3d(0.5, 0.25, 1.5));
  CHECK(volume->origin_mm == Eigen::Vector3d(10, 0, 0));
  REQUIRE(volume->labels.size() == 24);
  CHECK(volume->labels[1 + 2 * (2 + 3 * 3)] == 23);
}

TEST_CASE("label volume: 16 bits in both byte orders, packed or not") {
  const test::TemporaryFolder folder;
  const std::string head = k2x3x4 + "PIXSIZE=16 bits\n";
  const auto little = read_inr(folder.write("v.inr", header(head + "CPU=decm\n") + counting_bytes(48)));
  REQUIRE(little.has_value());
  CHECK(little->labels[23] == 46 + 256 * 47);

  const std::string big = header(head + "CPU=sun\n") + counting_bytes(48);
  gzFile file = gzopen(folder.path("v.inr.gz").c_str(), "wb");
  gzwrite(file, big.data(), static_cast<unsigned>(big.size()));
  gzclose(file);
  const auto packed = read_inr(folder.path("v.inr.gz"));
  REQUIRE(packed.has_value());
  CHECK(packed->labels[23] == 256 * 46 + 47);
}

TEST_CASE("label volume: broken files have their stated error") {
  const test::TemporaryFolder folder;
  const std::string good = k2x3x4 + "PIXSIZE=8 bits\nCPU=decm\n";
  const auto code = [&](const std::string& bytes) {
    const auto volume = read_inr(folder.write("v.inr", bytes));
    return volume ? std::string("read") : std::string(name(volume.error().code));
  };
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return code(header(text) + counting_bytes(24));
  };
  CHECK(with("XDIM=2", "XDIM=2") == "read");
  CHECK(code("") == "unsupported_format");
  CHECK(code("ply\n") == "unsupported_format");
  CHECK(code(header(good).substr(0, 200)) == "parse_failed");
  CHECK(code(header(good) + counting_bytes(23)) == "parse_failed");
  CHECK(with("XDIM=2", "XDIM=0") == "parse_failed");
  CHECK(with("XDIM=2", "XDIM=two") == "parse_failed");
  CHECK(with("XDIM=2", "XDIM=1e12") == "too_large");
  CHECK(with("XDIM=2\nYDIM=3\nZDIM=4", "XDIM=8000\nYDIM=8000\nZDIM=8000") == "too_large");
  CHECK(with("XDIM=2\nYDIM=3", "XDIM=8000\nYDIM=8000") == "parse_failed");  // 256 MB declared, 24 bytes there
  CHECK(with("VY=0.25", "VY=nan") == "parse_failed");
  CHECK(with("VY=0.25", "VY=0") == "parse_failed");
  CHECK(with("unsigned fixed", "float") == "unsupported_format");
  CHECK(with("8 bits", "32 bits") == "unsupported_format");
  CHECK(with("VDIM=1", "VDIM=3") == "unsupported_format");
  CHECK(code(header(k2x3x4 + "PIXSIZE=16 bits\n") + std::string(48, '\xFF')) == "bad_contour");
  CHECK(read_inr(folder.path("none.inr")).error().code == ErrorCode::file_not_found);
  CHECK(read_inr(folder.path(".")).error().code == ErrorCode::io_failed);
}
