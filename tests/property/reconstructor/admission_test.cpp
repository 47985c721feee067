#include <doctest/doctest.h>

#include "core/field/cpu/cpu_evaluator.h"
#include "core/reconstructor/cell_admission.h"
#include "tests/support/planes.h"
#include "tests/support/view_slices.h"

using namespace sonoloft;

TEST_CASE("admission: cells kept from slice to slice answer as cells packed anew, with 1 or 2 threads") {
  const Eigen::AlignedBox3d box(Eigen::Vector3d::Constant(-120), Eigen::Vector3d::Constant(120));
  CellComplex cells(box, 0.5);
  Background background(box, 4);
  const auto evaluator = make_cpu_evaluator(1);
  CellAdmission kept;
  std::vector<SliceId> held;
  std::size_t judged = 0, differ = 0;

  const auto judge = [&](const Section& section) {
    const auto widths = kept.judge(section, cells, background, *evaluator, 2);
    const auto anew = CellAdmission().judge(section, cells, background, *evaluator, 1);
    REQUIRE(widths);
    REQUIRE(anew);
    judged += widths->size();
    differ += *widths != *anew;
    return *widths;
  };
  const auto width_in = [](const CellAdmission::Widths& widths) {
    return [&widths](CellId cell) {
      const auto found = widths.find(cell);
      return found == widths.end() ? 1e9 : found->second;
    };
  };

  const auto frames = test::hand_sweep(1000, 5);
  for (std::size_t i = 0; i < 60; ++i) {
    auto section = make_section(test::slice_of_balls(frames[i * 16], test::body(), test::sector_view()));
    REQUIRE(section);
    const CellAdmission::Widths widths = judge(*section);
    const auto delta = cells.insert(std::move(*section), width_in(widths));
    REQUIRE(delta);
    kept.forget(delta->divided);
    background.add(cells.section(delta->slice));
    held.push_back(delta->slice);
    if (i % 20 != 19) continue;
    const SliceId gone = held[i / 2];
    background.remove(cells.section(gone));
    const CellComplex::Withdrawal withdrawal = cells.withdraw(gone);
    kept.forget(withdrawal.removed);
    held.erase(held.begin() + static_cast<std::ptrdiff_t>(i / 2));
    for (const SliceId slice : held) {
      const CellAdmission::Widths again = judge(cells.section(slice));
      kept.forget(cells.insert_again(slice, withdrawal, width_in(again)).divided);
    }
  }
  MESSAGE(cells.cell_count() << " cells; " << judged << " times one was to be cut");
  CHECK(cells.cell_count() > 50);
  CHECK(judged > 100);
  CHECK(differ == 0);
}
