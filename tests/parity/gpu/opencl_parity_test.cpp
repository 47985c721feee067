#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/gpu/opencl_evaluator.h"
#include "tests/support/field_parity.h"

using namespace sonoloft;

TEST_CASE("field: the OpenCL kernel, with vectors and without, is within 1e-5 of a cell of the double field") {
  for (const KernelForm form : {KernelForm::by_device, KernelForm::scalar}) {
    const auto evaluator = make_opencl_evaluator(1, form);
    if (!evaluator && evaluator.error().code == ErrorCode::no_opencl_device) {
      MESSAGE("SKIPPED: " << evaluator.error().message);
      return;
    }
    REQUIRE_MESSAGE(evaluator, evaluator.error().message);
    test::check_parity(**evaluator);
  }
}

TEST_CASE("field: OpenCL and the CPU twin agree to 1e-4 on a handful of points (also run by oclgrind)") {
  test::Random random(23);
  const std::array<Label, 4> labels = {0, 1, 2, kUnknown};
  FieldBatch expected;
  for (int i = 0; i < 3; ++i) {
    const test::FieldCell cell(test::random_walls(random, 5 + i, labels, 5, 30.0));
    std::vector<Eigen::Vector3d> points(30);
    for (Eigen::Vector3d& p : points) p = cell.random_point(random);
    expected.add_points(expected.cells.add(cell.faces(), cell.centre()), points);
  }
  REQUIRE(make_cpu_evaluator(1)->evaluate(expected));
  for (const KernelForm form : {KernelForm::by_device, KernelForm::scalar}) {
    const auto evaluator = make_opencl_evaluator(1, form);
    if (!evaluator && evaluator.error().code == ErrorCode::no_opencl_device) {
      MESSAGE("SKIPPED: " << evaluator.error().message);
      return;
    }
    REQUIRE_MESSAGE(evaluator, evaluator.error().message);
    FieldBatch batch = expected;
    REQUIRE((*evaluator)->evaluate(batch));
    float worst = 0;
    for (std::size_t i = 0; i < batch.share.size(); ++i)
      worst = std::max(worst, std::abs(batch.share[i] - expected.share[i]));
    CHECK(worst < 1e-4f);
    MESSAGE((*evaluator)->name() << ": " << batch.share.size() << " shares, at most " << worst << " apart");
  }
}
