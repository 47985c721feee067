#pragma once
// What the host packs and the kernels read: included by C++ and, as text, by OpenCL. All 4-byte members, no padding.
#ifdef __OPENCL_VERSION__
typedef uint u32;
#else
#include <cstdint>
#include <type_traits>
namespace sonoloft::kernels {
using u32 = std::uint32_t;
#endif

/// Points evaluated together: points of a block are padded to a multiple of this.
#define SONOLOFT_LANES 16
/// PackedRun::right of the pieces of an outline, which border on no label of the face.
#define SONOLOFT_NO_SLOT 0xFFFFFFFFu
/// Points are held this far off the walls, in units of the cell's size: on a wall the field has no value, beside it
/// has.
#define SONOLOFT_MIN_HEIGHT 1e-6f
/// What a stretch of a contour may change of a share at most where two edges stand for it.
#define SONOLOFT_STRETCH_ERROR 2e-4f

/// A directed edge of a face in units of the cell's size; origin: the foot of the cell's centre on the plane.
typedef struct PackedEdge {
  float x, y;              ///< start
  float along_x, along_y;  ///< end - start
  float length2;           ///< |end - start|^2, > 0
} PackedEdge;

/// A vertex of a chain of edges that moves along (outward_x, outward_y) with the height over its face: by
/// (2 a / (1 + max(-c a, 0)) + c h^2) / (2 + fading4 h^4), where a = slope h sqrt(share of the face), c = curvature.
typedef struct PackedVertex {
  float x, y;
  float outward_x, outward_y;
  float slope;      ///< per height on the cell's side
  float curvature;  ///< one over the cell's size
  float fading4;    ///< to the power of 4, one over the cell's size
} PackedVertex;

/// A stretch of a chain. After it come the stretches that it is halved into, if any. From afar two edges stand for it:
/// from its first vertex by way of `middle`, which none of them is, to its last.
typedef struct PackedStretch {
  float x, y;             ///< where it is
  float least2;           ///< squared distance beyond which that is allowed; infinity: never
  float rest, sway, bow;  ///< (rest + sway h + bow h^2) / distance^4: what it changes of the face's weight at most
  u32 first, count;       ///< the edges between vertices [first, first + count]
  u32 next;               ///< the stretch after all that it is halved into, counted from the run's first
  PackedVertex middle;
} PackedStretch;

/// Edges of one face with the same labels beside them.
typedef struct PackedRun {
  u32 first, count;  ///< rigid: edges [first, first + count); bent: the edges between vertices [first, first + count]
  u32 left, right;   ///< slots; right may be SONOLOFT_NO_SLOT
  u32 first_stretch, stretch_count;  ///< of long bent chains
} PackedRun;

/// A face: maps a point relative to the cell's centre (mm) to its foot and height in units of the cell's size.
typedef struct PackedFace {
  float ux, uy, uz;
  float vx, vy, vz;
  float nx, ny, nz, height;                ///< (nx, ny, nz) points into the cell; height is that of the centre
  u32 first_run, rigid_count, bent_count;  ///< runs: the rigid ones, then the bent
  u32 first_outline, outline_count;        ///< edges around the whole face, when there are bent runs
} PackedFace;

typedef struct PackedCell {
  u32 first_face, face_count;
  u32 slot_count;
  u32 first_label;
} PackedCell;

/// SONOLOFT_LANES points of one cell; the share of slot s of lane i goes to share[first_share + s * stride + i].
typedef struct PackedTask {
  u32 cell;
  u32 first_point;
  u32 first_share, stride;
  u32 first_weight;  ///< room for a weight of every face and lane
} PackedTask;

#ifndef __OPENCL_VERSION__
static_assert(sizeof(PackedEdge) == 20 && sizeof(PackedVertex) == 28 && sizeof(PackedRun) == 24 &&
              sizeof(PackedStretch) == 64);
static_assert(sizeof(PackedFace) == 60 && sizeof(PackedCell) == 16 && sizeof(PackedTask) == 20);
static_assert(std::is_trivially_copyable_v<PackedFace>);
}  // namespace sonoloft::kernels
#endif
