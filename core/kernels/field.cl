// The shares of the labels at the points of cells: one work-item takes SONOLOFT_WIDTH points of a task. A processor
// wants 4 to 16 of them in a vector, a graphics device 1. CPU twin: core/field/cpu/cpu_kernel.cpp.
#include "core/kernels/layout.h"

// A lane must not depend on how the compiler fuses the code around it: fuse by hand or not at all.
#pragma OPENCL FP_CONTRACT OFF

#define SONOLOFT_JOIN(a, b) a##b
#define SONOLOFT_VECTOR(name, width) SONOLOFT_JOIN(name, width)

#if SONOLOFT_WIDTH == 1
typedef float Real;
typedef int Mask;  // 1 where true
#define pick(mask, a, b) ((mask) ? (a) : (b))
#define all_lanes(mask) (mask)
#define any_lane(mask) (mask)
#define load(address) (*(address))
#define store(a, address) (*(address) = (a))
#else
typedef SONOLOFT_VECTOR(float, SONOLOFT_WIDTH) Real;
typedef SONOLOFT_VECTOR(int, SONOLOFT_WIDTH) Mask;  // -1 where true
#define pick(mask, a, b) select(b, a, mask)
#define all_lanes(mask) all(mask)
#define any_lane(mask) any(mask)
#define load(address) SONOLOFT_VECTOR(vload, SONOLOFT_WIDTH)(0, address)
#define store(a, address) SONOLOFT_VECTOR(vstore, SONOLOFT_WIDTH)(a, 0, address)
#endif

#define splat(f) ((Real)(f))
#define above(a, b) ((a) > (b))
#define larger(a, b) pick((a) > (b), a, b)
#define square_root(a) sqrt(a)
#define inverse_root(a) rsqrt(a)
#define magnitude(a) fabs(a)
#if defined(FP_FAST_FMAF) || defined(__FMA__)
#define multiply_add(a, b, c) fma(a, b, c)
#else
#define multiply_add(a, b, c) ((a) * (b) + (c))
#endif
#define SONOLOFT_FUNCTION static
#define SONOLOFT_GLOBAL __global

#include "core/kernels/field_sum.h"

__kernel void field_shares(__global const PackedCell* cells, __global const PackedFace* faces,
                           __global const PackedRun* runs, __global const PackedEdge* edges,
                           __global const PackedVertex* vertices, __global const PackedStretch* stretches,
                           __global const PackedTask* tasks, u32 first_task, u32 last_task, __global const float* x, __global const float* y, __global const float* z,
                           __global float* weight, __global float* share) {
  const u32 pieces = SONOLOFT_LANES / SONOLOFT_WIDTH;  // of a task
  const u32 index = (u32)get_global_id(0);
  if (first_task + index / pieces >= last_task) return;
  const PackedTask task = tasks[first_task + index / pieces];
  const u32 lane = index % pieces * SONOLOFT_WIDTH;
  const u32 point = task.first_point + lane;
  const FieldBuffers buffers = {cells, faces, runs, edges, vertices, stretches, weight, share};
  write_shares(&buffers, task, lane, load(x + point), load(y + point), load(z + point));
}
