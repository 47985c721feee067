#include "core/field/field_evaluator.h"

#include <cstddef>

namespace sonoloft {
namespace {

/// What was not measured is outside: the one place where the field is told so. The row of kUnknown stays as it is.
void fill_unknown(FieldBatch& batch) {
  for (std::uint32_t block = 0; block < batch.blocks.size(); ++block) {
    const std::span<const Label> labels = batch.cells.labels(batch.blocks[block].cell);
    if (labels.back() != kUnknown) continue;
    const std::span<float> outside = batch.row(block, 0);
    const std::span<const float> unknown = batch.row(block, static_cast<std::uint32_t>(labels.size() - 1));
    for (std::size_t i = 0; i < outside.size(); ++i) outside[i] += unknown[i];
  }
}

}  // namespace

Result<void> FieldEvaluator::evaluate(FieldBatch& batch) {
  batch.share.resize(batch.share_count);
  if (batch.tasks.empty()) return {};
  Result<void> done = compute_shares(batch);
  if (done) fill_unknown(batch);
  return done;
}

}  // namespace sonoloft
