#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/gpu/opencl_evaluator.h"
#include "tests/support/field/field_parity.h"
#include "tests/support/field/long_contours.h"

using namespace sonoloft;

namespace {

/// The evaluator with vectors and the one without; none where there is no OpenCL device, which is said.
std::vector<std::unique_ptr<FieldEvaluator>> evaluators() {
  std::vector<std::unique_ptr<FieldEvaluator>> both;
  for (const KernelForm form : {KernelForm::by_device, KernelForm::scalar}) {
    auto evaluator = make_opencl_evaluator(1, form);
    if (!evaluator && evaluator.error().code == ErrorCode::no_opencl_device) {
      MESSAGE("SKIPPED: " << evaluator.error().message);
      return {};
    }
    REQUIRE_MESSAGE(evaluator, evaluator.error().message);
    both.push_back(std::move(*evaluator));
  }
  return both;
}

}  // namespace

TEST_CASE("field: the OpenCL kernel, with vectors and without, is within 1e-5 of a cell of the double field") {
  for (const auto& evaluator : evaluators())
    for (const test::Borders borders : {test::Borders::stay, test::Borders::move})
      test::check_parity(*evaluator, borders);
}

TEST_CASE("field: OpenCL takes two edges for far stretches of long contours as the CPU twin does") {
  for (const auto& evaluator : evaluators()) test::check_long_contours(*evaluator, 1e-5, 2e-4);
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
  const FieldBatch points = expected;
  REQUIRE(make_cpu_evaluator(1)->evaluate(expected));
  const auto mixed = std::count_if(expected.share.begin(), expected.share.end(),
                                   [](float share) { return share > 0.05f && share < 0.95f; });
  REQUIRE(mixed > 50);
  for (const auto& evaluator : evaluators()) {
    FieldBatch batch = points;  // without shares: all that is compared was written here
    REQUIRE(batch.share.empty());
    REQUIRE(evaluator->evaluate(batch));
    REQUIRE(batch.share.size() == expected.share.size());
    float worst = 0;
    for (std::size_t i = 0; i < batch.share.size(); ++i) {
      const float apart = std::abs(batch.share[i] - expected.share[i]);
      REQUIRE(apart < 1e-4f);
      worst = std::max(worst, apart);
    }
    MESSAGE(evaluator->name() << ": " << batch.share.size() << " shares, at most " << worst << " apart");
  }
}
