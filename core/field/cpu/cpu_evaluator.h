#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/field/cpu/cpu_kernel.h"
#include "core/field/field_evaluator.h"

namespace sonoloft {

struct CpuKernel {
  void (*run)(const kernels::CpuKernelArguments& arguments, kernels::u32 first, kernels::u32 last);
  std::string instructions;
};

/// Those that this machine can run, the fastest first; never empty.
[[nodiscard]] std::vector<CpuKernel> usable_cpu_kernels();

/// @pre threads >= 1
[[nodiscard]] std::unique_ptr<FieldEvaluator> make_cpu_evaluator(const CpuKernel& kernel, int threads);

}  // namespace sonoloft
