#pragma once
#include "core/kernels/layout.h"

namespace sonoloft::kernels {

/// The buffers of a FieldBatch. Plain pointers, since the kernel is compiled once per instruction set and must not
/// share inline functions with code for machines that lack it.
struct CpuKernelArguments {
  const PackedCell* cells;
  const PackedFace* faces;
  const PackedRun* runs;
  const PackedEdge* edges;
  const PackedVertex* vertices;
  const PackedStretch* stretches;
  const PackedTask* tasks;
  const float *x, *y, *z;
  float *weight, *share;
};

/// Tasks [first, last); different tasks may run on different threads.
void run_field_baseline(const CpuKernelArguments& arguments, u32 first, u32 last);
void run_field_avx2(const CpuKernelArguments& arguments, u32 first, u32 last);    ///< x86-64 with AVX2 and FMA
void run_field_avx512(const CpuKernelArguments& arguments, u32 first, u32 last);  ///< x86-64 with AVX-512F

}  // namespace sonoloft::kernels
