#include "core/tracking/transform_graph.h"

#include <doctest/doctest.h>

#include "core/tracking/image_plane.h"

using namespace sonoloft;
using Eigen::Affine3d;
using Eigen::Vector3d;

namespace {

Affine3d shifted(double x, double y, double z) {
  return Affine3d(Eigen::Translation3d(x, y, z));
}

Affine3d turned(double angle, const Vector3d& axis) {
  return Affine3d(Eigen::AngleAxisd(angle, axis.normalized()));
}

}  // namespace

TEST_CASE("transforms: a name is taken apart at its one To") {
  const auto name = parse_transform_name("ProbeToTracker");
  REQUIRE(name);
  CHECK(name->from == "Probe");
  CHECK(name->to == "Tracker");
  CHECK(parse_transform_name("TrackerToTool")->to == "Tool");
  CHECK(parse_transform_name("ToolToTracker")->from == "Tool");
  CHECK(parse_transform_name("StylusTipTo3DProbe")->to == "3DProbe");
  for (const char* none : {"", "Probe", "Stylus", "ToProbe", "ProbeTo", "AToBToC", "Total"})
    CHECK_FALSE(parse_transform_name(none));
}

TEST_CASE("transforms: any chain leads from one system to another, inverses included") {
  const Affine3d image_to_probe = turned(0.3, {1, 2, 3}) * Eigen::Scaling(0.1, 0.2, 0.15);
  const Affine3d probe_to_tracker = shifted(10, -4, 100) * turned(1, {0, 1, 1});
  const Affine3d reference_to_tracker = shifted(7, 8, 9) * turned(-2, {1, 0, 0});
  const Affine3d phantom_to_reference = shifted(0, 5, 0);
  TransformGraph graph;
  graph.set(PlusConfig{{{"Image", "Probe", image_to_probe}, {"Phantom", "Reference", phantom_to_reference}}, {}});
  SequenceFrame frame;
  frame.transforms["ProbeToTracker"] = probe_to_tracker;
  frame.transforms["ReferenceToTracker"] = reference_to_tracker;
  frame.transforms["StylusToTracker"] = std::nullopt;
  frame.transforms["NoName"] = Affine3d::Identity();
  graph.set(frame);
  const auto found = graph.find("Image", "Phantom");
  REQUIRE(found);
  const Affine3d expected =
      phantom_to_reference.inverse() * reference_to_tracker.inverse() * probe_to_tracker * image_to_probe;
  CHECK(found->isApprox(expected, 1e-12));
  REQUIRE(graph.find("Phantom", "Image"));
  CHECK(graph.find("Phantom", "Image")->isApprox(expected.inverse(), 1e-12));
  CHECK(graph.find("Image", "Image")->isApprox(Affine3d::Identity()));
  CHECK_FALSE(graph.find("Image", "Stylus"));  // it is not good now
  CHECK(graph.check_connected("Image", "Stylus"));
  frame.transforms["StylusToTracker"] = shifted(1, 2, 3);
  graph.set(frame);
  CHECK(graph.find("Stylus", "Tracker")->isApprox(shifted(1, 2, 3)));
}

TEST_CASE("transforms: the shortest way counts, and a frame's transform replaces the configuration's") {
  TransformGraph graph;
  graph.set("A", "B", shifted(1, 0, 0));
  graph.set("B", "C", shifted(1, 0, 0));
  CHECK(graph.find("A", "C")->translation().x() == 2);
  graph.set("C", "A", shifted(-5, 0, 0));
  CHECK(graph.find("A", "C")->translation().x() == 5);
  graph.set("A", "C", std::nullopt);  // the other way round, and not good: the long way is left
  CHECK(graph.find("A", "C")->translation().x() == 2);
}

TEST_CASE("transforms: where no chain leads, the error says what there is") {
  TransformGraph graph;
  graph.set("Probe", "Tracker", shifted(1, 0, 0));
  graph.set("Reference", "Tracker", std::nullopt);
  const auto missing = graph.check_connected("Image", "Reference");
  REQUIRE_FALSE(missing);
  CHECK(missing.error().code == ErrorCode::invalid_argument);
  CHECK(missing.error().message.find("from Image to Reference: joined are {Image} and {Reference, Tracker, Probe}") !=
        std::string::npos);
}

TEST_CASE("transforms: between two things of a frame only what is rigid counts") {
  SequenceFrame frame;
  frame.transforms["ProbeToTracker"] = shifted(1.5, 0, 3) * turned(1.57, {0, 0, 1});
  frame.transforms["ReferenceToTracker"] = shifted(1, 0, 0);
  frame.transforms["ImageToProbe"] = Affine3d(Eigen::Scaling(0.1));
  const auto between = transform_between(frame, "Probe", "Reference");
  REQUIRE(between);
  CHECK(between->translation().isApprox(Vector3d(0.5, 0, 3)));
  CHECK_FALSE(transform_between(frame, "Image", "Reference"));
  CHECK_FALSE(transform_between(frame, "Stylus", "Reference"));
  Affine3d rounded = turned(0.7, {3, 1, 2});
  rounded.linear() = (1e4 * rounded.linear()).array().round().matrix() / 1e4;
  REQUIRE(rigid(rounded));
  CHECK(rigid(rounded)->linear().isApprox(turned(0.7, {3, 1, 2}).linear(), 1e-4));
  CHECK(rigid(rounded)->linear().isUnitary(1e-12));
  CHECK_FALSE(rigid(Affine3d(Eigen::Scaling(1.0, 1.0, -1.0))));
}

TEST_CASE("image plane: pixels land where the calibration puts them, square or not") {
  Affine3d calibration = shifted(-30, 20, 70) * turned(1.2, {2, -1, 1});
  calibration = calibration * Eigen::Scaling(0.1, 0.25, 0.3);
  calibration.linear().col(1) += 0.02 * calibration.linear().col(0);  // not quite at right angles
  const auto plane = image_plane(calibration);
  REQUIRE(plane);
  CHECK(plane->image_to_reference.linear().isUnitary(1e-12));
  CHECK(plane->image_to_reference.linear().determinant() == doctest::Approx(1));
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(0, 0), Eigen::Vector2d(819, 0), Eigen::Vector2d(17, 615)}) {
    const Eigen::Vector2d mm = plane->mm_per_pixel * pixel;
    const Vector3d there = plane->image_to_reference * Vector3d(mm.x(), mm.y(), 0);
    CHECK(there.isApprox(calibration * Vector3d(pixel.x(), pixel.y(), 0), 1e-12));
  }
  Affine3d flat = calibration;
  flat.linear().col(1) = 2 * flat.linear().col(0);
  CHECK_FALSE(image_plane(flat));
}
