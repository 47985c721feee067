#include <doctest/doctest.h>

#include <vector>

#include "core/field/cpu_evaluator.h"
#include "tests/support/field/field_parity.h"

using namespace sonoloft;

TEST_CASE("field: the CPU twin of every instruction set is within 1e-5 of a cell of the double field") {
  for (const CpuKernel& kernel : usable_cpu_kernels())
    test::check_parity(*make_cpu_evaluator(kernel, 1), test::Borders::stay);
}

TEST_CASE("field: the same where contours move with the height over their wall") {
  for (const CpuKernel& kernel : usable_cpu_kernels())
    test::check_parity(*make_cpu_evaluator(kernel, 1), test::Borders::move);
}
