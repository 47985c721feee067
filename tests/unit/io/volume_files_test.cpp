#include "core/io/volumes/volume_files.h"

#include <doctest/doctest.h>
#include <zlib.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>

#include "core/io/meshes/mesh_files.h"
#include "tests/support/temporary_folder.h"

using namespace sonoloft;
using test::TemporaryFolder;

namespace {

/// Label 7 in one corner, 40000 in a row of three; nowhere symmetric.
LabelVolume small_volume() {
  LabelVolume volume{{5, 4, 3}, {0.7, 1.25, 2}, {-30.5, 12.25, 1e3}, std::vector<Label>(60, kOutside)};
  volume.labels[0] = 7;
  for (const std::size_t x : {2u, 3u, 4u}) volume.labels[x + 5 * (1 + 4 * 2)] = 40000;
  return volume;
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Whether packed or not.
std::string unpacked(const std::filesystem::path& path) {
  gzFile file = gzopen(path.c_str(), "rb");
  REQUIRE(file != nullptr);
  std::string bytes(100000, '\0');
  const int count = gzread(file, bytes.data(), static_cast<unsigned>(bytes.size()));
  REQUIRE(count >= 0);
  REQUIRE(gzclose(file) == Z_OK);
  bytes.resize(static_cast<std::size_t>(count));
  return bytes;
}

std::vector<Label> labels_in(std::string_view bytes) {
  std::vector<Label> labels(bytes.size() / sizeof(Label));
  REQUIRE(bytes.size() == labels.size() * sizeof(Label));
  std::memcpy(labels.data(), bytes.data(), bytes.size());
  return labels;
}

template <class T>
std::vector<T> numbers_at(const std::string& bytes, std::size_t offset, std::size_t count) {
  std::vector<T> numbers(count);
  REQUIRE(bytes.size() >= offset + count * sizeof(T));
  std::memcpy(numbers.data(), bytes.data() + offset, count * sizeof(T));
  return numbers;
}

}  // namespace

TEST_CASE("volume files: a .seg.nrrd has its fields, a segment for every label, and the voxels") {
  const TemporaryFolder folder;
  const LabelVolume volume = small_volume();
  REQUIRE(write_seg_nrrd(volume, folder.path("v.seg.nrrd")));
  const std::string bytes = bytes_of(folder.path("v.seg.nrrd"));
  const std::size_t end = bytes.find("\n\n");
  REQUIRE(end != std::string::npos);
  std::istringstream head(bytes.substr(0, end + 1));
  std::map<std::string, std::string> fields;
  std::string line;
  std::getline(head, line);
  CHECK(line == "NRRD0005");
  while (std::getline(head, line)) {
    const std::size_t colon = line.find(':');
    REQUIRE(colon != std::string::npos);
    CHECK(fields.emplace(line.substr(0, colon), line.substr(colon + 2)).second);
  }
  CHECK(fields["type"] == "unsigned short");
  CHECK(fields["sizes"] == "5 4 3");
  CHECK(fields["space"] == "left-posterior-superior");
  CHECK(fields["space directions"] == "(0.7,0,0) (0,1.25,0) (0,0,2)");
  CHECK(fields["space origin"] == "(-30.5,12.25,1000)");
  CHECK(fields["space units"] == "\"mm\" \"mm\" \"mm\"");
  CHECK(fields["encoding"] == "gzip");
  CHECK(fields["Segment0_Name"] == "label 7");
  CHECK(fields["Segment0_LabelValue"] == "7");
  CHECK(fields["Segment0_Layer"] == "0");
  CHECK(fields["Segment0_Extent"] == "0 0 0 0 0 0");
  CHECK(fields["Segment1_ID"] == "Segment_40000");
  CHECK(fields["Segment1_LabelValue"] == "40000");
  CHECK(fields["Segment1_Extent"] == "2 4 1 1 2 2");
  CHECK_FALSE(fields.contains("Segment2_ID"));
  std::istringstream colour(fields["Segment0_Color"]);
  for (const std::uint8_t channel : label_colour(7)) {
    double share = -1;
    colour >> share;
    CHECK(share * 255 == doctest::Approx(channel));
  }
  std::ofstream(folder.path("voxels.gz"), std::ios::binary) << bytes.substr(end + 2);
  CHECK(labels_in(unpacked(folder.path("voxels.gz"))) == volume.labels);
}

TEST_CASE("volume files: a NIfTI file has sizes, units and the way from LPS to RAS, packed or not") {
  const TemporaryFolder folder;
  const LabelVolume volume = small_volume();
  REQUIRE(write_nifti(volume, folder.path("v.nii")));
  REQUIRE(write_nifti(volume, folder.path("v.nii.gz")));
  const std::string bytes = bytes_of(folder.path("v.nii"));
  CHECK(bytes == unpacked(folder.path("v.nii.gz")));
  CHECK(bytes_of(folder.path("v.nii.gz")).starts_with("\x1f\x8b"));
  REQUIRE(bytes.size() == 352 + 120);
  CHECK(numbers_at<std::int32_t>(bytes, 0, 1) == std::vector{348});
  CHECK(numbers_at<std::int16_t>(bytes, 40, 8) == std::vector<std::int16_t>{3, 5, 4, 3, 1, 1, 1, 1});
  CHECK(numbers_at<std::int16_t>(bytes, 68, 3) == std::vector<std::int16_t>{1002, 512, 16});
  CHECK(numbers_at<float>(bytes, 76, 4) == std::vector{1.f, 0.7f, 1.25f, 2.f});
  CHECK(numbers_at<float>(bytes, 108, 2) == std::vector{352.f, 1.f});
  CHECK(bytes[123] == 2);
  CHECK(numbers_at<std::int16_t>(bytes, 252, 2) == std::vector<std::int16_t>{1, 1});
  CHECK(numbers_at<float>(bytes, 256, 6) == std::vector{0.f, 0.f, 1.f, 30.5f, -12.25f, 1000.f});
  CHECK(numbers_at<float>(bytes, 280, 12) ==
        std::vector{-0.7f, 0.f, 0.f, 30.5f, 0.f, -1.25f, 0.f, -12.25f, 0.f, 0.f, 2.f, 1000.f});
  CHECK(bytes.substr(344, 8) == std::string("n+1\0\0\0\0\0", 8));
  CHECK(labels_in(std::string_view(bytes).substr(352)) == volume.labels);
}

TEST_CASE("volume files: a file is replaced, and where none can be written the error says so") {
  const TemporaryFolder folder;
  LabelVolume volume = small_volume();
  volume.labels.assign(60, kOutside);
  for (const char* file : {"v.seg.nrrd", "v.nii", "v.nii.gz"}) {
    const auto write = [&](const LabelVolume& voxels, const std::filesystem::path& path) {
      return std::string(file).ends_with("nrrd") ? write_seg_nrrd(voxels, path) : write_nifti(voxels, path);
    };
    REQUIRE(write(volume, folder.path(file)));
    const std::string once = bytes_of(folder.path(file));
    folder.write(file, std::string(100000, 'x'));
    REQUIRE(write(volume, folder.path(file)));
    CHECK(bytes_of(folder.path(file)) == once);
    const auto nowhere = write(volume, folder.path("nowhere") / file);
    REQUIRE_FALSE(nowhere);
    CHECK(nowhere.error().code == ErrorCode::io_failed);
    CHECK(nowhere.error().message.find("nowhere") != std::string::npos);
  }
}
