// The arithmetic of the field, read by both the OpenCL kernel and its CPU twin. Who includes it has defined
//   Real, Mask                       numbers of the lanes side by side, and the outcome of comparing them: &, !
//   above(a, b), pick(mask, a, b)    per lane: a > b; mask ? a : b
//   larger(a, b)                     pick(above(a, b), a, b)
//   all_lanes(mask), any_lane(mask)  whether it holds in every lane, in one
//   square_root(a), inverse_root(a) = 1 / sqrt(a), magnitude(a), splat(f), load(address), store(a, address)
//   multiply_add(a, b, c)            a * b + c
//   SONOLOFT_FUNCTION, SONOLOFT_GLOBAL   how a function is declared; the address space of the buffers
// Formulas: docs/pipeline/4-field.md.

typedef struct FieldBuffers {
  SONOLOFT_GLOBAL const PackedCell* cells;
  SONOLOFT_GLOBAL const PackedFace* faces;
  SONOLOFT_GLOBAL const PackedRun* runs;
  SONOLOFT_GLOBAL const PackedEdge* edges;
  SONOLOFT_GLOBAL const PackedVertex* vertices;
  SONOLOFT_GLOBAL const PackedStretch* stretches;
  SONOLOFT_GLOBAL float* weight;
  SONOLOFT_GLOBAL float* share;
} FieldBuffers;

/// Angles from 0 to pi: theta / w with tan(theta) = w / v, w = sqrt(w2) > 0. @param inverse  1 / v
SONOLOFT_FUNCTION Real any_angle_quotient(Real v, Real w2, Real inverse) {
  const Real inverse_w = inverse_root(w2);
  const Real w = w2 * inverse_w;
  const Real flat = magnitude(v);
  const Mask steep = above(w, flat);
  const Real z = pick(steep, flat * inverse_w, w * magnitude(inverse));
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
  angle = pick(above(splat(0.0f), v), splat(3.14159265f) - angle, angle);
  return angle * inverse_w;
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
  const Mask narrow = above(v, splat(0.0f)) & above(splat(0.25f), t2);
  if (all_lanes(narrow)) return narrow_quotient;
  return pick(narrow, narrow_quotient, any_angle_quotient(v, w2, inverse));
}

/// Where the points see a face from.
typedef struct Foot {
  Real x, y, h, h2;
  Real half_h2, half_h4;
} Foot;

SONOLOFT_FUNCTION Foot foot_on(SONOLOFT_GLOBAL const PackedFace* face, Real x, Real y, Real z) {
  Foot foot;
  foot.x = multiply_add(splat(face->ux), x, multiply_add(splat(face->uy), y, splat(face->uz) * z));
  foot.y = multiply_add(splat(face->vx), x, multiply_add(splat(face->vy), y, splat(face->vz) * z));
  const Real height = multiply_add(
      splat(face->nx), x, multiply_add(splat(face->ny), y, multiply_add(splat(face->nz), z, splat(face->height))));
  foot.h = larger(height, splat(SONOLOFT_MIN_HEIGHT));
  foot.h2 = foot.h * foot.h;
  foot.half_h2 = splat(0.5f) * foot.h2;
  foot.half_h4 = foot.half_h2 * foot.h2;
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
  const Real c = splat(vertex->curvature), a = splat(vertex->slope) * reach;
  const Real slow = larger(multiply_add(-c, a, splat(1.0f)), splat(1.0f));
  const Real fading = multiply_add(splat(vertex->fading4), foot.half_h4, splat(1.0f));
  return multiply_add(c * foot.half_h2, slow, a) / (slow * fading);
}

/// Where the foot of a point sees a vertex that has moved.
typedef struct Seen {
  Real x, y;
} Seen;

SONOLOFT_FUNCTION Seen seen_from(SONOLOFT_GLOBAL const PackedVertex* vertex, Foot foot, Real reach) {
  const Real moved = displacement(vertex, foot, reach);
  Seen seen;
  seen.x = multiply_add(moved, splat(vertex->outward_x), splat(vertex->x)) - foot.x;
  seen.y = multiply_add(moved, splat(vertex->outward_y), splat(vertex->y)) - foot.y;
  return seen;
}

/// sum + D * q of the edge from a to b.
SONOLOFT_FUNCTION Real add_edge(Real sum, Seen a, Seen b, Foot foot) {
  const Real along_x = b.x - a.x, along_y = b.y - a.y;
  const Real cross = multiply_add(a.x, along_y, -(a.y * along_x));
  const Real length2 = multiply_add(along_x, along_x, along_y * along_y);
  const Real w2 = multiply_add(cross, cross, length2 * foot.h2);
  const Real v = multiply_add(a.x, b.x, multiply_add(a.y, b.y, foot.h2));
  return multiply_add(cross, angle_quotient(v, w2), sum);
}

/// sum + the same as sum_edges() for the `count` edges between moved vertices, the first of which is seen at *at; then
/// the last one is.
SONOLOFT_FUNCTION Real add_bent_edges(Real sum, SONOLOFT_GLOBAL const PackedVertex* vertex, u32 count, Foot foot,
                                      Real reach, Seen* at) {
  Seen a = *at;
  for (u32 i = 0; i < count; ++i) {
    ++vertex;
    const Seen b = seen_from(vertex, foot, reach);
    sum = add_edge(sum, a, b, foot);
    a = b;
  }
  *at = a;
  return sum;
}

/// The same as sum_edges() for a chain between moved vertices.
SONOLOFT_FUNCTION Real sum_bent_edges(SONOLOFT_GLOBAL const PackedVertex* vertex, u32 count, Foot foot, Real reach) {
  Seen at = seen_from(vertex, foot, reach);
  return add_bent_edges(splat(0.0f), vertex, count, foot, reach, &at);
}

/// The same for a chain in stretches: each lane takes two edges for those that are far from it, and what it gets does
/// not depend on the lanes beside it. @param bar  what a stretch may change of the sum over h
SONOLOFT_FUNCTION Real sum_stretches(SONOLOFT_GLOBAL const PackedStretch* stretches, u32 count,
                                     SONOLOFT_GLOBAL const PackedVertex* vertices, Foot foot, Real reach, Real bar) {
  Real sum = splat(0.0f);
  Real next = splat(0.0f);                                        // of each lane: the first stretch that it has not yet
  Seen at = seen_from(vertices + stretches->first, foot, reach);  // the first vertex of the stretch at hand
  for (u32 i = 0; i < count;) {
    SONOLOFT_GLOBAL const PackedStretch* stretch = stretches + i;
    const Real dx = splat(stretch->x) - foot.x, dy = splat(stretch->y) - foot.y;
    const Real distance2 = multiply_add(dx, dx, multiply_add(dy, dy, foot.h2));
    const Mask open = above(splat((float)i + 0.5f), next);
    const Mask far =
        open & above(distance2, splat(stretch->least2)) &
        above(distance2 * distance2 * bar, multiply_add(multiply_add(splat(stretch->bow), foot.h, splat(stretch->sway)),
                                                        foot.h, splat(stretch->rest)));
    const Mask near = open & !far;
    SONOLOFT_GLOBAL const PackedVertex* first = vertices + stretch->first;
    Seen end = at;
    if (any_lane(far)) {
      const Seen middle = seen_from(&stretch->middle, foot, reach);
      end = seen_from(first + stretch->count, foot, reach);
      const Real both = add_edge(add_edge(splat(0.0f), at, middle, foot), middle, end, foot);
      sum = pick(far, sum + both, sum);
      next = pick(far, splat((float)stretch->next), next);
    }
    if (!any_lane(near)) {
      i = stretch->next;
      at = end;
      continue;
    }
    ++i;
    if (stretch->next != i) continue;
    sum = pick(near, add_bent_edges(sum, first, stretch->count, foot, reach, &at), sum);
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

  const Real bar = total * splat(0.5f * SONOLOFT_STRETCH_ERROR);
  for (u32 f = 0; f < cell.face_count && bent_count != 0; ++f) {
    SONOLOFT_GLOBAL const PackedFace* face = buffers->faces + cell.first_face + f;
    if (face->bent_count == 0) continue;
    const Foot foot = foot_on(face, x, y, z);
    const Real of_face = load(weight + f * SONOLOFT_LANES) / total;
    const Real reach = foot.h * square_root(larger(of_face, splat(0.0f)));
    SONOLOFT_GLOBAL const PackedRun* run = buffers->runs + face->first_run + face->rigid_count;
    for (u32 r = 0; r < face->bent_count; ++r, ++run) {
      const Real chain = run->stretch_count != 0
                             ? sum_stretches(buffers->stretches + run->first_stretch, run->stretch_count,
                                             buffers->vertices, foot, reach, bar)
                             : sum_bent_edges(buffers->vertices + run->first, run->count, foot, reach);
      const Real part = chain / foot.h;
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
