#include <doctest/doctest.h>

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
