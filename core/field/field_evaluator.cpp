#include "core/field/field_evaluator.h"

namespace sonoloft {

Result<void> FieldEvaluator::evaluate(FieldBatch& batch) {
  batch.share.resize(batch.share_count);
  if (batch.tasks.empty()) return {};
  return compute_shares(batch);
}

}  // namespace sonoloft
