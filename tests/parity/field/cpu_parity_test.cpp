#include <doctest/doctest.h>

#include <vector>

#include "core/field/cpu/cpu_evaluator.h"
#include "tests/support/field/field_parity.h"
#include "tests/support/field/long_contours.h"

using namespace sonoloft;

TEST_CASE("field: the CPU twin of every instruction set is within 1e-5 of a cell of the double field") {
  for (const CpuKernel& kernel : usable_cpu_kernels())
    test::check_parity(*make_cpu_evaluator(kernel, 1), test::Borders::stay);
}

TEST_CASE("field: the same where contours move with the height over their wall") {
  for (const CpuKernel& kernel : usable_cpu_kernels())
    test::check_parity(*make_cpu_evaluator(kernel, 1), test::Borders::move);
}

TEST_CASE("field: two edges for far stretches of long contours change no share by 2e-4, and 1e-5 on average") {
  for (const CpuKernel& kernel : usable_cpu_kernels())
    test::check_long_contours(*make_cpu_evaluator(kernel, 1), 1e-5, 2e-4);
}

TEST_CASE("field: a share among long contours does not depend on the points beside it, to the last bit") {
  const test::FieldCell cell = test::wavy_cell(1500);
  test::Random random(6);
  std::vector<Eigen::Vector3d> points(200);
  for (Eigen::Vector3d& p : points) p = cell.random_point(random);
  FieldBatch together, alone;
  const std::uint32_t one = together.cells.add(cell.faces(), cell.centre(), {}, cell.bends());
  alone.cells.add(cell.faces(), cell.centre(), {}, cell.bends());
  const std::uint32_t all = together.add_points(one, points);
  std::vector<std::uint32_t> each;
  for (const Eigen::Vector3d& p : points) each.push_back(alone.add_points(one, std::vector{p}));
  for (const CpuKernel& kernel : usable_cpu_kernels()) {
    const auto evaluator = make_cpu_evaluator(kernel, 1);
    REQUIRE(evaluator->evaluate(together));
    REQUIRE(evaluator->evaluate(alone));
    int different = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      different += together.row(all, 1)[i] != alone.row(each[i], 1)[0] ? 1 : 0;
    CHECK(different == 0);
  }
}
