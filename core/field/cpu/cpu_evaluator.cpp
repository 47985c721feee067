#include "core/field/cpu/cpu_evaluator.h"

#include <cassert>
#include <utility>

#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

/// Small enough to keep all threads busy to the end, large enough that handing out costs nothing.
constexpr std::size_t kTasksPerPiece = 32;

class CpuEvaluator final : public FieldEvaluator {
 public:
  CpuEvaluator(CpuKernel kernel, int threads) : kernel_(std::move(kernel)), threads_(threads) { assert(threads >= 1); }

  [[nodiscard]] std::string name() const override {
    return "CPU (" + kernel_.instructions + ", " + std::to_string(threads_) +
           (threads_ == 1 ? " thread)" : " threads)");
  }

 private:
  [[nodiscard]] Result<void> compute_shares(FieldBatch& batch) override {
    batch.weight.resize(batch.weight_count);
    const kernels::CpuKernelArguments arguments = {batch.cells.cells().data(),
                                                   batch.cells.faces().data(),
                                                   batch.cells.runs().data(),
                                                   batch.cells.edges().data(),
                                                   batch.cells.vertices().data(),
                                                   batch.cells.stretches().data(),
                                                   batch.tasks.data(),
                                                   batch.x.data(),
                                                   batch.y.data(),
                                                   batch.z.data(),
                                                   batch.weight.data(),
                                                   batch.share.data()};
    parallel_for(batch.tasks.size(), kTasksPerPiece, threads_, [&](std::size_t first, std::size_t last) {
      kernel_.run(arguments, static_cast<kernels::u32>(first), static_cast<kernels::u32>(last));
    });
    return {};
  }

  CpuKernel kernel_;
  int threads_;
};

}  // namespace

std::vector<CpuKernel> usable_cpu_kernels() {
  std::vector<CpuKernel> found;
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512f")) found.push_back({kernels::run_field_avx512, "AVX-512"});
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    found.push_back({kernels::run_field_avx2, "AVX2"});
#endif
  found.push_back({kernels::run_field_baseline, "baseline"});
  return found;
}

std::unique_ptr<FieldEvaluator> make_cpu_evaluator(const CpuKernel& kernel, int threads) {
  return std::make_unique<CpuEvaluator>(kernel, threads);
}

std::unique_ptr<FieldEvaluator> make_cpu_evaluator(int threads) {
  return make_cpu_evaluator(usable_cpu_kernels().front(), threads);
}

}  // namespace sonoloft
