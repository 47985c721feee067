#include "core/gpu/make_evaluator.h"

#include <doctest/doctest.h>

#include <array>
#include <string>
#include <vector>

#include "core/gpu/opencl_evaluator.h"
#include "tests/support/field_batches.h"

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

TEST_CASE("evaluator: automatic always gives one, and says why it is not OpenCL") {
  lines.clear();
  const auto opencl = make_evaluator(DeviceChoice::opencl, 1, {});
  const auto automatic = make_evaluator(DeviceChoice::automatic, 1, kLog);
  REQUIRE(automatic);
  if (opencl) {
    CHECK((*automatic)->name() == (*opencl)->name());
    CHECK(lines.size() == 1);
  } else {
    CHECK(opencl.error().code == ErrorCode::no_opencl_device);
    CHECK((*automatic)->name().find("CPU (") == 0);
    REQUIRE(lines.size() == 2);
    CHECK(lines[0].find(opencl.error().message) != std::string::npos);
  }
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
