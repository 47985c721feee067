#include <doctest/doctest.h>
#include <zlib.h>

#include "core/io/sequences/tracked_sequence.h"
#include "tests/support/sequence_file.h"

using namespace sonoloft;
using test::Fields;
using test::frame_fields;
using test::meta_image;

namespace {

/// As zlib packs, or as gzip does.
std::string packed(const std::string& bytes, bool gzip) {
  z_stream stream{};
  REQUIRE(deflateInit2(&stream, 6, Z_DEFLATED, MAX_WBITS + (gzip ? 16 : 0), 8, Z_DEFAULT_STRATEGY) == Z_OK);
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  REQUIRE(deflate(&stream, Z_FINISH) == Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

Fields two_frames(const std::string& first_time = "7417.731300", const std::string& second_time = "7417.816414") {
  Fields fields = frame_fields(0, "0 -1 0 1.5 1 0 0 -8.43482e-005 0 0 1 3 -0 0 -0 1 ", first_time);
  for (const auto& field : frame_fields(1, test::kUnitMatrix, second_time, "INVALID")) fields.push_back(field);
  return fields;
}

const Fields kPacked = {{"CompressedData", "True"}};
const std::string kPixels = "abcdefABCDEF";

TrackedSequence read(const std::string& bytes) {
  auto sequence = parse_tracked_sequence(bytes, "x");
  REQUIRE_MESSAGE(sequence, (sequence ? "" : sequence.error().message));
  return std::move(*sequence);
}

std::string pixels_of(const std::string& bytes) {
  const TrackedSequence sequence = read(bytes);
  return {sequence.images.pixels.begin(), sequence.images.pixels.end()};
}

ErrorCode refusal(const std::string& bytes) {
  const auto sequence = parse_tracked_sequence(bytes, "x.igs.mha");
  REQUIRE_FALSE(sequence);
  CHECK(sequence.error().message.starts_with("x.igs.mha"));
  return sequence.error().code;
}

/// Numbers of two or four bytes.
std::string wide(const std::string& pixels, std::size_t bytes, bool big_endian) {
  std::string out;
  for (const char c : pixels)
    for (std::size_t k = 0; k < bytes; ++k) out += k == (big_endian ? bytes - 1 : 0) ? c : '\0';
  return out;
}

}  // namespace

TEST_CASE("sequence: images, times and transforms are read, of both formats, packed or not") {
  const std::string gzip_header = "encoding: gzip\nkinds: domain domain list\n";
  for (const std::string& bytes :
       {meta_image("3 2 2   ", two_frames(), kPixels),
        meta_image("3 2 2", two_frames(), packed(kPixels, false), kPacked),
        meta_image("3 2 1 2", two_frames(), kPixels), test::nrrd("3 2 2", two_frames(), kPixels),
        test::nrrd("3 2 2", two_frames(), packed(kPixels, true), gzip_header),
        test::nrrd("3 2 1 2", two_frames(), kPixels, "encoding: raw\r\nkinds: domain domain domain list\r\n")}) {
    const TrackedSequence sequence = read(bytes);
    CHECK(std::string(sequence.images.pixels.begin(), sequence.images.pixels.end()) == kPixels);
    CHECK(sequence.images.dims == std::array<std::uint32_t, 3>{3, 2, 2});
    REQUIRE(sequence.frames.size() == 2);
    CHECK(sequence.frames[0].time.count() == 7417'731300000);
    CHECK(sequence.frames[0].image_ok);
    const auto& pose = sequence.frames[0].transforms.at("ProbeToTracker");
    REQUIRE(pose);
    CHECK(pose->translation() == Eigen::Vector3d(1.5, -8.43482e-005, 3));
    CHECK(pose->linear()(0, 1) == -1);
    CHECK_FALSE(sequence.frames[1].transforms.at("ProbeToTracker"));  // its status is not OK
  }
}

TEST_CASE("sequence: whole numbers of other sizes are read where their values fit") {
  CHECK(pixels_of(meta_image("3 2 2", two_frames(), wide(kPixels, 2, false), {}, "MET_SHORT")) == kPixels);
  CHECK(pixels_of(meta_image("3 2 2", two_frames(), wide(kPixels, 4, true), {{"BinaryDataByteOrderMSB", "True"}},
                             "MET_UINT")) == kPixels);
  CHECK(pixels_of(test::nrrd("3 2 2", two_frames(), wide(kPixels, 2, true), "encoding: raw\nendian: big\n",
                             "unsigned short")) == kPixels);
  std::string high = wide(kPixels, 2, false);
  high[5] = 1;
  CHECK(refusal(meta_image("3 2 2", two_frames(), high, {}, "MET_USHORT")) == ErrorCode::unsupported_format);
  high[5] = '\xff';
  CHECK(refusal(meta_image("3 2 2", two_frames(), high, {}, "MET_SHORT")) == ErrorCode::unsupported_format);
}

TEST_CASE("sequence: images come out with the transducer above and its mark to the left") {
  const auto turned = [](const char* orientation) {
    return pixels_of(meta_image("3 2 2", two_frames(), kPixels, {{"UltrasoundImageOrientation", orientation}}));
  };
  CHECK(turned("MF") == "abcdefABCDEF");
  CHECK(turned("MFA") == "abcdefABCDEF");
  CHECK(turned("UF") == "cbafedCBAFED");
  CHECK(turned("MN") == "defabcDEFABC");
  CHECK(turned("UNA") == "fedcbaFEDCBA");
  CHECK(pixels_of(test::nrrd("3 2 2", two_frames(), kPixels, "encoding: raw\nultrasound image orientation:=UF\n")) ==
        "cbafedCBAFED");
  CHECK(refusal(meta_image("3 2 2", two_frames(), kPixels, {{"UltrasoundImageOrientation", "FM"}})) ==
        ErrorCode::unsupported_format);
}

TEST_CASE("sequence: an image is good unless its status says otherwise") {
  Fields fields = two_frames();
  fields[3].second = "INVALID";
  fields.pop_back();
  const TrackedSequence sequence = read(meta_image("3 2 2", fields, kPixels));
  CHECK_FALSE(sequence.frames[0].image_ok);
  CHECK(sequence.frames[1].image_ok);
}

TEST_CASE("sequence: recordings of poses alone have no pixels") {
  for (const std::string& bytes : {meta_image("0 0 2", two_frames(), ""), meta_image("0 0 0 2", two_frames(), ""),
                                   test::nrrd("0 0 2", two_frames(), "")}) {
    const TrackedSequence sequence = read(bytes);
    CHECK(sequence.images.pixels.empty());
    REQUIRE(sequence.frames.size() == 2);
    CHECK_FALSE(sequence.frames[0].image_ok);
  }
}

TEST_CASE("sequence: files that break their rules are refused with the reason") {
  const auto dims = [](const char* text) { return meta_image(text, two_frames(), kPixels); };
  CHECK(refusal("PNG") == ErrorCode::unsupported_format);
  CHECK(refusal("ObjectType = Image\n") == ErrorCode::parse_failed);
  CHECK(refusal("ObjectType = Image\nno equals sign\n") == ErrorCode::parse_failed);
  CHECK(refusal("NRRD0005\ntype: uchar\n") == ErrorCode::parse_failed);
  CHECK(refusal(dims("3 2")) == ErrorCode::unsupported_format);
  CHECK(refusal(dims("3 2 2 2")) == ErrorCode::unsupported_format);  // a volume each time
  CHECK(refusal(dims("3 2 3")) == ErrorCode::parse_failed);          // more pixels than there are
  CHECK(refusal(dims("65536 65536 65536")) == ErrorCode::too_large);
  const auto frames = [](const Fields& fields) { return meta_image("3 2 2", fields, kPixels); };
  CHECK(refusal(frames(frame_fields(0, test::kUnitMatrix))) == ErrorCode::parse_failed);  // no time in the second
  CHECK(refusal(frames(two_frames("2", "1"))) == ErrorCode::parse_failed);
  CHECK(refusal(frames(two_frames("noon"))) == ErrorCode::parse_failed);
  CHECK(refusal(frames(two_frames("1e300"))) == ErrorCode::parse_failed);
  for (const char* matrix : {"1 0 0", "1 0 0 0 0 1 0 0 0 0 0 0 0 0 0 1", "1 0 0 0 0 1 0 0 0 0 1 0 0 1 0 1"}) {
    Fields fields = two_frames();
    fields[0].second = matrix;
    CHECK(refusal(frames(fields)) == ErrorCode::parse_failed);
  }
  std::string cut = meta_image("3 2 2", two_frames(), packed(kPixels, false), kPacked);
  cut.resize(cut.size() - 6);
  CHECK(refusal(cut) == ErrorCode::parse_failed);
  CHECK(refusal(meta_image("3 2 2", two_frames(), kPixels, {}, "MET_FLOAT")) == ErrorCode::unsupported_format);
  CHECK(refusal(meta_image("3 2 2", two_frames(), kPixels, {{"ElementNumberOfChannels", "3"}})) ==
        ErrorCode::unsupported_format);
  for (const char* header : {"encoding: bzip2\n", "encoding: raw\ndata file: pixels.raw\n",
                             "encoding: raw\nkinds: vector domain domain list\n", "encoding: raw\nline skip: 2\n"})
    CHECK(refusal(test::nrrd("3 2 2", two_frames(), kPixels, header)) == ErrorCode::unsupported_format);
}
