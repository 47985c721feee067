#include "core/tracking/tracked_sequence.h"

#include <doctest/doctest.h>
#include <zlib.h>

#include <string>

using namespace sonoloft;

namespace {

std::string packed(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  REQUIRE(compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                   bytes.size()) == Z_OK);
  out.resize(size);
  return out;
}

const std::string kPose = "0 -1 0 1.5 1 0 0 -8.43482e-005 0 0 1 3 0 0 -0 1 ";

std::string frame_text(int index, const std::string& time, const std::string& status = "OK") {
  const std::string key = "Seq_Frame000" + std::to_string(index) + "_";
  return key + "ProbeToTrackerTransform = " + kPose + "\n" + key + "ProbeToTrackerTransformStatus = " + status + "\n" +
         key + "ReferenceToTrackerTransform = 1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1\n" + key +
         "ReferenceToTrackerTransformStatus = OK\n" + key + "Timestamp = " + time + "\n" + key + "ImageStatus = OK\n";
}

std::string file(const std::string& frames, const std::string& dims = "3 2 2   ", bool pack = true,
                 const std::string& pixels = "abcdefABCDEF") {
  return std::string("ObjectType = Image\nNDims = 3\nCompressedData = ") + (pack ? "True" : "False") +
         "\nDimSize = " + dims + "\nElementType = MET_UCHAR\n" + frames + "ElementDataFile = LOCAL\n" +
         (pack ? packed(pixels) : pixels);
}

ErrorCode refusal(const std::string& bytes) {
  const auto read = parse_tracked_sequence(bytes, "x.igs.mha");
  REQUIRE_FALSE(read);
  CHECK(read.error().message.starts_with("x.igs.mha"));
  return read.error().code;
}

const std::string kTwoFrames = frame_text(0, "7417.731300") + frame_text(1, "7417.816414", "INVALID");

}  // namespace

TEST_CASE("sequence: images, times and poses are read, packed or not") {
  for (const bool pack : {true, false}) {
    const auto read = parse_tracked_sequence(file(kTwoFrames, "3 2 2   ", pack), "x");
    REQUIRE(read);
    CHECK(std::string(read->images.pixels.begin(), read->images.pixels.end()) == "abcdefABCDEF");
    REQUIRE(read->frames.size() == 2);
    CHECK(read->frames[0].time.count() == 7417'731300000);
    CHECK(read->frames[0].image_ok);
    const auto& pose = read->frames[0].transforms.at("ProbeToTracker");
    REQUIRE(pose);
    CHECK(pose->translation() == Eigen::Vector3d(1.5, -8.43482e-005, 3));
    CHECK_FALSE(read->frames[1].transforms.at("ProbeToTracker"));  // its status is not OK
    const auto between = transform_between(read->frames[0], "Probe", "Reference");
    REQUIRE(between);
    CHECK(between->translation().x() == 0.5);
    CHECK_FALSE(transform_between(read->frames[1], "Probe", "Reference"));
    CHECK_FALSE(transform_between(read->frames[0], "Stylus", "Reference"));
  }
}

TEST_CASE("sequence: recordings of poses alone have no pixels") {
  const auto read = parse_tracked_sequence(file(kTwoFrames, "0 0 2", false, ""), "x");
  REQUIRE(read);
  CHECK(read->images.pixels.empty());
  CHECK(read->frames.size() == 2);
}

TEST_CASE("sequence: files that break their rules are refused with the reason") {
  CHECK(refusal("PNG") == ErrorCode::unsupported_format);
  CHECK(refusal("ObjectType = Image\n") == ErrorCode::parse_failed);
  CHECK(refusal("ObjectType = Image\nno equals sign\n") == ErrorCode::parse_failed);
  CHECK(refusal(file(kTwoFrames, "3 2")) == ErrorCode::parse_failed);
  CHECK(refusal(file(kTwoFrames, "3 2 3")) == ErrorCode::parse_failed);  // more pixels than there are
  CHECK(refusal(file(kTwoFrames, "65536 65536 65536")) == ErrorCode::too_large);
  CHECK(refusal(file(frame_text(0, "1"))) == ErrorCode::parse_failed);  // the second frame has no time
  CHECK(refusal(file(frame_text(0, "2") + frame_text(1, "1"))) == ErrorCode::parse_failed);
  CHECK(refusal(file(frame_text(0, "noon") + frame_text(1, "1"))) == ErrorCode::parse_failed);
  CHECK(refusal(file(frame_text(0, "1e300") + frame_text(1, "1"))) == ErrorCode::parse_failed);
  std::string sheared = kTwoFrames;
  sheared.replace(sheared.find("0 -1 0"), 6, "0 -2 0");
  CHECK(refusal(file(sheared)) == ErrorCode::not_rigid);
  std::string cut = file(kTwoFrames);
  cut.resize(cut.size() - 6);
  CHECK(refusal(cut) == ErrorCode::parse_failed);
  std::string twelve_bit = file(kTwoFrames);
  twelve_bit.replace(twelve_bit.find("MET_UCHAR"), 9, "MET_SHORT");
  CHECK(refusal(twelve_bit) == ErrorCode::unsupported_format);
}
