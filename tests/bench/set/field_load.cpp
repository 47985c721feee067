#include "tests/bench/set/field_load.h"

#include "core/cells/cell_complex.h"
#include "core/gpu/make_evaluator.h"
#include "core/octree/sample_octree.h"
#include "tests/bench/support/reconstruction.h"

namespace sonoloft::bench {
namespace {

/// Passes batches on and counts what is in them.
class CountingEvaluator final : public FieldEvaluator {
 public:
  explicit CountingEvaluator(std::unique_ptr<FieldEvaluator> evaluator) : evaluator_(std::move(evaluator)) {}
  [[nodiscard]] std::string name() const override { return evaluator_->name(); }
  [[nodiscard]] double evaluations() const { return evaluations_; }

 private:
  Result<void> compute_shares(FieldBatch& batch) override {
    for (const FieldBlock& block : batch.blocks)
      evaluations_ += static_cast<double>(block.count) * batch.cells.edge_count(block.cell);
    return evaluator_->evaluate(batch);
  }

  std::unique_ptr<FieldEvaluator> evaluator_;
  double evaluations_ = 0;
};

}  // namespace

double edge_evaluations(std::span<const TrackedSlice> slices, const ReconstructorOptions& options) {
  CountingEvaluator evaluator(or_exit(make_evaluator(DeviceChoice::cpu, options.threads, {})));
  CellComplex cells(options.box, 0.25 * options.spacing_mm);
  SampleOctree octree(options.box.min(), options.spacing_mm);
  for (const TrackedSlice& slice : slices)
    if (const auto delta = cells.insert(or_exit(make_section(slice)))) octree.note(cells, *delta);
  or_exit(octree.update(cells, evaluator, options.threads));
  return evaluator.evaluations();
}

}  // namespace sonoloft::bench
