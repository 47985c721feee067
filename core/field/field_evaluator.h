#pragma once
// Stage 2 of 5:  slice -> cells -> [FIELD] -> octree -> mesh -> callback
#include <memory>
#include <string>

#include "core/field/field_batch.h"
#include "core/slice/result.h"

namespace sonoloft {

/// Mean value interpolation of the labels on the walls of a convex cell to the points in it: the share of label l at x
/// is
///   f_l(x) = S_l(x) / T(x),   S_l = sum over the cell's faces of  integral over the region of l of  h / |y - x|^4 dA,
/// T the sum over all labels. On a wall f is the wall's label, so fields of neighbouring cells meet; on a border
/// between two labels it is 1/2. What is unknown on the walls is a label like the others here: its share is what was
/// not measured of the point, for the background to fill. Source: Bermano, Vaxman, Gotsman 2011, sections 4.3 and 4.4;
/// closed form in docs/pipeline/4-field.md. A share is a function of the point and its cell alone, to the last bit:
/// neither of the points evaluated beside it nor of the number of threads. Evaluators of different kinds agree up to
/// rounding.
class FieldEvaluator {
 public:
  virtual ~FieldEvaluator() = default;

  /// Computes batch.share for every block.
  /// @error opencl_failed: batch.share is meaningless
  /// @cost  O(sum over blocks of #points * #edges of the cell); no allocation per point
  /// Threads: one call at a time; uses its own helpers inside.
  [[nodiscard]] Result<void> evaluate(FieldBatch& batch);

  /// For logs and reports, e.g. "CPU (AVX2, 2 threads)".
  [[nodiscard]] virtual std::string name() const = 0;

 private:
  /// Writes S_l / T for every slot. @pre there is a task
  [[nodiscard]] virtual Result<void> compute_shares(FieldBatch& batch) = 0;
};

/// The evaluator that needs no device: the CPU twin of the OpenCL kernel, with the widest vectors the machine has.
/// @pre threads >= 1
[[nodiscard]] std::unique_ptr<FieldEvaluator> make_cpu_evaluator(int threads);

}  // namespace sonoloft
