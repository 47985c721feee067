// Compiled once for every instruction set, as SONOLOFT_CPU_KERNEL: see CMakeLists.txt.
#include "core/field/cpu/cpu_kernel.h"

#if defined(__SSE2__)
#include <immintrin.h>
#else
#include <cmath>
#endif
#include <cstring>

namespace sonoloft::kernels {
namespace {

#define SONOLOFT_FUNCTION inline __attribute__((always_inline))
#define SONOLOFT_GLOBAL

#if defined(__AVX512F__)
// Comparisons have registers of their own here. The masked forms: gcc 12 warns of its own header in the plain ones.
constexpr u32 kWidth = 16;
using Real = __m512;
struct Mask {
  __mmask16 lanes;
};
SONOLOFT_FUNCTION Mask operator&(Mask a, Mask b) {
  return {static_cast<__mmask16>(a.lanes & b.lanes)};
}
SONOLOFT_FUNCTION Mask operator!(Mask a) {
  return {static_cast<__mmask16>(~a.lanes)};
}
SONOLOFT_FUNCTION Mask above(Real a, Real b) {
  return {_mm512_cmp_ps_mask(a, b, _CMP_GT_OQ)};
}
SONOLOFT_FUNCTION Real pick(Mask mask, Real a, Real b) {
  return _mm512_mask_blend_ps(mask.lanes, b, a);
}
SONOLOFT_FUNCTION Real larger(Real a, Real b) {
  return _mm512_maskz_max_ps(0xFFFF, a, b);
}
SONOLOFT_FUNCTION bool all_lanes(Mask mask) {
  return mask.lanes == 0xFFFF;
}
SONOLOFT_FUNCTION bool any_lane(Mask mask) {
  return mask.lanes != 0;
}
SONOLOFT_FUNCTION Real splat(float f) {
  return _mm512_set1_ps(f);
}
SONOLOFT_FUNCTION Real square_root(Real a) {
  return _mm512_maskz_sqrt_ps(0xFFFF, a);
}
SONOLOFT_FUNCTION Real magnitude(Real a) {
  return _mm512_abs_ps(a);
}
SONOLOFT_FUNCTION Real multiply_add(Real a, Real b, Real c) {
  return _mm512_fmadd_ps(a, b, c);
}
#else
#if defined(__AVX2__)
constexpr u32 kWidth = 8;
#else
constexpr u32 kWidth = 4;
#endif
using Real = float __attribute__((vector_size(kWidth * sizeof(float))));
using Mask = int __attribute__((vector_size(kWidth * sizeof(float))));  // -1 where true, 0 where false

SONOLOFT_FUNCTION Mask above(Real a, Real b) {
  return a > b;
}
SONOLOFT_FUNCTION Real pick(Mask mask, Real a, Real b) {
  return mask ? a : b;
}
SONOLOFT_FUNCTION Real larger(Real a, Real b) {
  return a > b ? a : b;
}
SONOLOFT_FUNCTION Real magnitude(Real a) {
  return reinterpret_cast<Real>(reinterpret_cast<Mask>(a) & 0x7FFFFFFF);
}
#if defined(__AVX2__)
SONOLOFT_FUNCTION Real splat(float f) {
  return _mm256_set1_ps(f);
}
SONOLOFT_FUNCTION bool all_lanes(Mask mask) {
  return _mm256_movemask_ps(reinterpret_cast<__m256>(mask)) == 0xFF;
}
SONOLOFT_FUNCTION Real square_root(Real a) {
  return _mm256_sqrt_ps(a);
}
SONOLOFT_FUNCTION Real multiply_add(Real a, Real b, Real c) {
  return _mm256_fmadd_ps(a, b, c);
}
#else
SONOLOFT_FUNCTION Real splat(float f) {
  return Real{f, f, f, f};
}
#if defined(__SSE2__)
SONOLOFT_FUNCTION bool all_lanes(Mask mask) {
  return _mm_movemask_ps(reinterpret_cast<__m128>(mask)) == 0xF;
}
SONOLOFT_FUNCTION Real square_root(Real a) {
  return _mm_sqrt_ps(a);
}
#else
SONOLOFT_FUNCTION bool all_lanes(Mask mask) {
  return (mask[0] & mask[1] & mask[2] & mask[3]) != 0;
}
SONOLOFT_FUNCTION Real square_root(Real a) {
  return Real{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}
#endif
SONOLOFT_FUNCTION Real multiply_add(Real a, Real b, Real c) {
  return a * b + c;
}
#endif
SONOLOFT_FUNCTION bool any_lane(Mask mask) {
  return !all_lanes(!mask);
}
#endif
SONOLOFT_FUNCTION Real inverse_root(Real a) {
  return splat(1.0f) / square_root(a);
}

SONOLOFT_FUNCTION void store(Real a, float* address) {
  std::memcpy(address, &a, sizeof a);
}
SONOLOFT_FUNCTION Real load(const float* address) {
  Real a;
  std::memcpy(&a, address, sizeof a);
  return a;
}

#include "core/kernels/field_sum.h"

}  // namespace

void SONOLOFT_CPU_KERNEL(const CpuKernelArguments& arguments, u32 first, u32 last) {
  const FieldBuffers buffers = {arguments.cells,    arguments.faces,     arguments.runs,   arguments.edges,
                                arguments.vertices, arguments.stretches, arguments.weight, arguments.share};
  for (u32 t = first; t < last; ++t) {
    const PackedTask task = arguments.tasks[t];
    for (u32 lane = 0; lane < SONOLOFT_LANES; lane += kWidth) {
      const u32 point = task.first_point + lane;
      write_shares(&buffers, task, lane, load(arguments.x + point), load(arguments.y + point),
                   load(arguments.z + point));
    }
  }
}

}  // namespace sonoloft::kernels
