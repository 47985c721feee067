#include "core/gpu/make_evaluator.h"

#include <doctest/doctest.h>

#include <array>
#include <string>
#include <vector>

#include "core/gpu/opencl_evaluator.h"
#include "tests/support/field/field_batches.h"

using namespace sonoloft;

namespace {

std::vector<std::string> lines;
const auto kLog = [](const std::string& line) { lines.push_back(line); };

}  // namespace

TEST_CASE("evaluator: fewer than one thread is refused with the remedy") {
  for (const DeviceChoice choice : {DeviceChoice::automatic, DeviceChoice::opencl, DeviceChoice::cpu}) {
    const auto evaluator = make_evaluator(choice, 0, {});
    REQUIRE(!evaluator);
    CHECK(evaluator.error().code == ErrorCode::invalid_argument);
    CHECK(evaluator.error().message.find("at least 1") != std::string::npos);
  }
}

TEST_CASE("evaluator: the CPU twin needs no device and says what it is") {
  lines.clear();
  const auto evaluator = make_evaluator(DeviceChoice::cpu, 2, kLog);
  REQUIRE(evaluator);
  CHECK((*evaluator)->name().find("CPU (") == 0);
  REQUIRE(lines.size() == 1);
  CHECK(lines[0].find((*evaluator)->name()) != std::string::npos);
}

TEST_CASE("evaluator: automatic always gives one: OpenCL but for a processor, and says why it is not OpenCL") {
  lines.clear();
  const auto graphics = make_opencl_evaluator(1, KernelForm::by_device, DeviceKinds::no_processors);
  const auto automatic = make_evaluator(DeviceChoice::automatic, 1, kLog);
  REQUIRE(automatic);
  if (graphics) {
    CHECK((*automatic)->name() == (*graphics)->name());
    CHECK(lines.size() == 1);
  } else {
    CHECK(graphics.error().code == ErrorCode::no_opencl_device);
    CHECK((*automatic)->name().find("CPU (") == 0);
    REQUIRE(lines.size() == 2);
    CHECK(lines[0].find(graphics.error().message) != std::string::npos);
    MESSAGE(lines[0]);
  }
}

TEST_CASE("evaluator: OpenCL on a processor is there for who asks for it") {
  const auto graphics = make_opencl_evaluator(1, KernelForm::by_device, DeviceKinds::no_processors);
  const auto named = make_evaluator(DeviceChoice::opencl, 1, {});
  if (!named) {
    CHECK(named.error().code == ErrorCode::no_opencl_device);
    MESSAGE("SKIPPED: " << named.error().message);
    return;
  }
  CHECK((*named)->name().find("OpenCL (") == 0);
  if (!graphics) CHECK(graphics.error().message.find("choose the device 'opencl'") != std::string::npos);
}

TEST_CASE("evaluator: OpenCL's shares have the same bits whatever is evaluated beside them and by how many threads") {
  test::Random random(21);
  const std::array<Label, 5> labels = {0, 1, 2, 3, kUnknown};
  test::ShuffledBatches batches(random, labels);
  for (const KernelForm form : {KernelForm::by_device, KernelForm::scalar}) {
    const auto one = make_opencl_evaluator(1, form), many = make_opencl_evaluator(64, form);
    if (!one && one.error().code == ErrorCode::no_opencl_device) {
      MESSAGE("SKIPPED: " << one.error().message);
      return;
    }
    REQUIRE_MESSAGE(one, one.error().message);
    REQUIRE_MESSAGE(many, many.error().message);
    MESSAGE((*one)->name() << " and " << (*many)->name());
    REQUIRE((*one)->evaluate(batches.straight));
    REQUIRE((*many)->evaluate(batches.shuffled));
    CHECK(batches.different_bits() == 0);
    REQUIRE((*one)->evaluate(batches.shuffled));
    CHECK(batches.different_bits() == 0);
  }
}

TEST_CASE("evaluator: a batch of many points, which OpenCL works off in pieces, has the bits of its blocks alone") {
  const auto evaluator = make_opencl_evaluator(2, KernelForm::by_device);
  if (!evaluator) {
    MESSAGE("SKIPPED: " << evaluator.error().message);
    return;
  }
  test::Random random(22);
  const std::array<Label, 3> labels = {0, 1, 2};
  FieldBatch together;
  std::vector<FieldBatch> alone(7);
  for (FieldBatch& one : alone) {
    const test::FieldCell cell(test::random_walls(random, 6, labels, 6, 30.0));
    std::vector<Eigen::Vector3d> points(30001);
    for (Eigen::Vector3d& p : points) p = cell.random_point(random);
    together.add_points(together.cells.add(cell.faces(), cell.centre()), points);
    one.add_points(one.cells.add(cell.faces(), cell.centre()), points);
  }
  REQUIRE((*evaluator)->evaluate(together));
  std::size_t different = 0, shares = 0;
  for (FieldBatch& one : alone) {
    REQUIRE((*evaluator)->evaluate(one));
    for (const float share : one.share) different += together.share[shares++] != share;
  }
  CHECK(shares == together.share.size());
  CHECK(different == 0);
  MESSAGE(together.tasks.size() << " tasks, " << shares << " shares, " << different << " different");
}
