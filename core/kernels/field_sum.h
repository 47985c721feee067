// The arithmetic of the field, read by both the OpenCL kernel and its CPU twin. Who includes it has defined
//   Real, Mask                       numbers of the lanes side by side, and the outcome of comparing them
//   pick(mask, a, b)                 per lane: mask ? a : b
//   all_lanes(mask)                  whether it holds in every lane
//   square_root(a), magnitude(a), splat(f), load(address), store(a, address), multiply_add(a, b, c) = a * b + c
//   SONOLOFT_FUNCTION, SONOLOFT_GLOBAL   how a function is declared; the address space of the buffers
// Formulas: docs/pipeline/4-field.md.

typedef struct FieldBuffers {
  SONOLOFT_GLOBAL const PackedCell* cells;
  SONOLOFT_GLOBAL const PackedFace* faces;
  SONOLOFT_GLOBAL const PackedRun* runs;
  SONOLOFT_GLOBAL const PackedEdge* edges;
  SONOLOFT_GLOBAL const PackedVertex* vertices;
  SONOLOFT_GLOBAL float* weight;
  SONOLOFT_GLOBAL float* share;
} FieldBuffers;

/// Angles from 0 to pi: theta / w with tan(theta) = w / v, w = sqrt(w2) > 0.
SONOLOFT_FUNCTION Real any_angle_quotient(Real v, Real w2) {
  const Real w = square_root(w2);
  const Real flat = magnitude(v);
  const Mask steep = w > flat;
  const Real z = pick(steep, flat, w) / pick(steep, w, flat);
  const Real z2 = z * z;
  Real p = multiply_add(z2, splat(-0.00469325574f), splat(0.0242523323f));
  p = multiply_add(z2, p, splat(-0.0594862962f));
  p = multiply_add(z2, p, splat(0.0991428625f));
  p = multiply_add(z2, p, splat(-0.140194786f));
  p = multiply_add(z2, p, splat(0.199697235f));
  p = multiply_add(z2, p, splat(-0.333319907f));
  p = multiply_add(z2, p, splat(0.999999901f));
  Real angle = z * p;
  angle = pick(steep, splat(1.57079633f) - angle, angle);
  angle = pick(v < splat(0.0f), splat(3.14159265f) - angle, angle);
  return angle / w;
}

/// The same, most often without root and arc tangent: nearly all edges are seen under less than 27 degrees. A lane's
/// result depends on its own v and w2 only, whatever the lanes beside it need.
SONOLOFT_FUNCTION Real angle_quotient(Real v, Real w2) {
  const Real inverse = splat(1.0f) / v;
  const Real t2 = w2 * inverse * inverse;
  Real p = multiply_add(t2, splat(0.0695217923f), splat(-0.134731366f));
  p = multiply_add(t2, p, splat(0.199315015f));
  p = multiply_add(t2, p, splat(-0.333312673f));
  p = multiply_add(t2, p, splat(0.999999899f));
  const Real narrow_quotient = inverse * p;
  const Mask narrow = (v > splat(0.0f)) & (t2 <= splat(0.25f));
  if (all_lanes(narrow)) return narrow_quotient;
  return pick(narrow, narrow_quotient, any_angle_quotient(v, w2));
}

/// Where the points see a face from.
typedef struct Foot {
  Real x, y, h, h2;
} Foot;

SONOLOFT_FUNCTION Foot foot_on(SONOLOFT_GLOBAL const PackedFace* face, Real x, Real y, Real z) {
  Foot foot;
  foot.x = multiply_add(splat(face->ux), x, multiply_add(splat(face->uy), y, splat(face->uz) * z));
  foot.y = multiply_add(splat(face->vx), x, multiply_add(splat(face->vy), y, splat(face->vz) * z));
  const Real height = multiply_add(
      splat(face->nx), x, multiply_add(splat(face->ny), y, multiply_add(splat(face->nz), z, splat(face->height))));
  foot.h = pick(height > splat(SONOLOFT_MIN_HEIGHT), height, splat(SONOLOFT_MIN_HEIGHT));
  foot.h2 = foot.h * foot.h;
  return foot;
}

/// Sum over directed edges of D * q: 2 h times what the region left of them weighs.
SONOLOFT_FUNCTION Real sum_edges(SONOLOFT_GLOBAL const PackedEdge* edge, u32 count, Foot foot) {
  Real sum = splat(0.0f);
  for (u32 i = 0; i < count; ++i, ++edge) {
    const Real along_x = splat(edge->along_x), along_y = splat(edge->along_y);
    const Real ax = splat(edge->x) - foot.x, ay = splat(edge->y) - foot.y;
    const Real cross = multiply_add(ax, along_y, -(ay * along_x));
    const Real w2 = multiply_add(cross, cross, splat(edge->length2) * foot.h2);
    const Real v = multiply_add(ax, ax + along_x, multiply_add(ay, ay + along_y, foot.h2));
    sum = multiply_add(cross, angle_quotient(v, w2), sum);
  }
  return sum;
}

/// How far a vertex moves. @param reach  h sqrt(share of the face)
SONOLOFT_FUNCTION Real displacement(SONOLOFT_GLOBAL const PackedVertex* vertex, Foot foot, Real reach) {
  const Real c = splat(vertex->curvature), fading = splat(vertex->fading);
  const Real a = splat(vertex->slope) * reach, fold = -(c * a);
  const Real slow = splat(1.0f) + pick(fold > splat(0.0f), fold, splat(0.0f));
  const Real u2 = fading * fading * foot.h2;
  return multiply_add(c * foot.h2, slow, a + a) / (slow * multiply_add(u2, u2, splat(2.0f)));
}

/// The same as sum_edges() for the `count` edges between moved vertices.
SONOLOFT_FUNCTION Real sum_bent_edges(SONOLOFT_GLOBAL const PackedVertex* vertex, u32 count, Foot foot, Real reach) {
  Real sum = splat(0.0f);
  Real moved = displacement(vertex, foot, reach);
  Real ax = multiply_add(moved, splat(vertex->outward_x), splat(vertex->x)) - foot.x;
  Real ay = multiply_add(moved, splat(vertex->outward_y), splat(vertex->y)) - foot.y;
  for (u32 i = 0; i < count; ++i) {
    ++vertex;
    moved = displacement(vertex, foot, reach);
    const Real bx = multiply_add(moved, splat(vertex->outward_x), splat(vertex->x)) - foot.x;
    const Real by = multiply_add(moved, splat(vertex->outward_y), splat(vertex->y)) - foot.y;
    const Real along_x = bx - ax, along_y = by - ay;
    const Real cross = multiply_add(ax, along_y, -(ay * along_x));
    const Real length2 = multiply_add(along_x, along_x, along_y * along_y);
    const Real w2 = multiply_add(cross, cross, length2 * foot.h2);
    const Real v = multiply_add(ax, bx, multiply_add(ay, by, foot.h2));
    sum = multiply_add(cross, angle_quotient(v, w2), sum);
    ax = bx;
    ay = by;
  }
  return sum;
}

SONOLOFT_FUNCTION void add_to(SONOLOFT_GLOBAL float* address, Real weight) {
  store(load(address) + weight, address);
}

/// Lanes [lane, lane + width of Real) of a task: the share of every slot of the cell at the points (x, y, z).
SONOLOFT_FUNCTION void write_shares(const FieldBuffers* buffers, PackedTask task, u32 lane, Real x, Real y, Real z) {
  const PackedCell cell = buffers->cells[task.cell];
  SONOLOFT_GLOBAL float* share = buffers->share + task.first_share + lane;
  SONOLOFT_GLOBAL float* weight = buffers->weight + task.first_weight + lane;
  for (u32 slot = 0; slot < cell.slot_count; ++slot) store(splat(0.0f), share + slot * task.stride);

  u32 bent_count = 0;
  Real total = splat(0.0f);
  for (u32 f = 0; f < cell.face_count; ++f) {
    SONOLOFT_GLOBAL const PackedFace* face = buffers->faces + cell.first_face + f;
    const Foot foot = foot_on(face, x, y, z);
    Real whole = splat(0.0f);
    SONOLOFT_GLOBAL const PackedRun* run = buffers->runs + face->first_run;
    for (u32 r = 0; r < face->rigid_count; ++r, ++run) {
      const Real part = sum_edges(buffers->edges + run->first, run->count, foot) / foot.h;
      add_to(share + run->left * task.stride, part);
      if (run->right == SONOLOFT_NO_SLOT)
        whole = whole + part;
      else
        add_to(share + run->right * task.stride, -part);
    }
    bent_count += face->bent_count;
    if (face->bent_count != 0)
      whole = sum_edges(buffers->edges + face->first_outline, face->outline_count, foot) / foot.h;
    store(whole, weight + f * SONOLOFT_LANES);
    total = total + whole;
  }

  for (u32 f = 0; f < cell.face_count && bent_count != 0; ++f) {
    SONOLOFT_GLOBAL const PackedFace* face = buffers->faces + cell.first_face + f;
    if (face->bent_count == 0) continue;
    const Foot foot = foot_on(face, x, y, z);
    const Real of_face = load(weight + f * SONOLOFT_LANES) / total;
    const Real reach = foot.h * square_root(pick(of_face > splat(0.0f), of_face, splat(0.0f)));
    SONOLOFT_GLOBAL const PackedRun* run = buffers->runs + face->first_run + face->rigid_count;
    for (u32 r = 0; r < face->bent_count; ++r, ++run) {
      const Real part = sum_bent_edges(buffers->vertices + run->first, run->count, foot, reach) / foot.h;
      add_to(share + run->left * task.stride, part);
      if (run->right != SONOLOFT_NO_SLOT) add_to(share + run->right * task.stride, -part);
    }
  }

  Real sum = splat(0.0f);
  for (u32 slot = 0; slot < cell.slot_count; ++slot) sum = sum + load(share + slot * task.stride);
  const Real scale = splat(1.0f) / sum;
  for (u32 slot = 0; slot < cell.slot_count; ++slot)
    store(load(share + slot * task.stride) * scale, share + slot * task.stride);
}
