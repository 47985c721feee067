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

/// Sum over directed edges of D * q: 2 h times what the region left of them weighs. (px, py) is the foot of the point.
SONOLOFT_FUNCTION Real sum_edges(SONOLOFT_GLOBAL const PackedEdge* edge, u32 count, Real px, Real py, Real h2) {
  Real sum = splat(0.0f);
  for (u32 i = 0; i < count; ++i, ++edge) {
    const Real along_x = splat(edge->along_x), along_y = splat(edge->along_y);
    const Real ax = splat(edge->x) - px, ay = splat(edge->y) - py;
    const Real cross = multiply_add(ax, along_y, -(ay * along_x));
    const Real w2 = multiply_add(cross, cross, splat(edge->length2) * h2);
    const Real v = multiply_add(ax, ax + along_x, multiply_add(ay, ay + along_y, h2));
    sum = multiply_add(cross, angle_quotient(v, w2), sum);
  }
  return sum;
}

/// Lanes [lane, lane + width of Real) of a task: the share of every slot of the cell at the points (x, y, z).
SONOLOFT_FUNCTION void write_shares(const FieldBuffers* buffers, PackedTask task, u32 lane, Real x, Real y, Real z) {
  const PackedCell cell = buffers->cells[task.cell];
  SONOLOFT_GLOBAL float* share = buffers->share + task.first_share + lane;
  for (u32 slot = 0; slot < cell.slot_count; ++slot) store(splat(0.0f), share + slot * task.stride);

  for (u32 f = 0; f < cell.face_count; ++f) {
    SONOLOFT_GLOBAL const PackedFace* face = buffers->faces + cell.first_face + f;
    const Real px = multiply_add(splat(face->ux), x, multiply_add(splat(face->uy), y, splat(face->uz) * z));
    const Real py = multiply_add(splat(face->vx), x, multiply_add(splat(face->vy), y, splat(face->vz) * z));
    const Real height = multiply_add(
        splat(face->nx), x, multiply_add(splat(face->ny), y, multiply_add(splat(face->nz), z, splat(face->height))));
    const Real h = pick(height > splat(SONOLOFT_MIN_HEIGHT), height, splat(SONOLOFT_MIN_HEIGHT));
    for (u32 r = face->first_run; r < face->first_run + face->run_count; ++r) {
      const PackedRun run = buffers->runs[r];
      const Real weight = sum_edges(buffers->edges + run.first_edge, run.edge_count, px, py, h * h) / h;
      SONOLOFT_GLOBAL float* left = share + run.left * task.stride;
      store(load(left) + weight, left);
      if (run.right == SONOLOFT_NO_SLOT) continue;
      SONOLOFT_GLOBAL float* right = share + run.right * task.stride;
      store(load(right) - weight, right);
    }
  }

  Real total = splat(0.0f);
  for (u32 slot = 0; slot < cell.slot_count; ++slot) total = total + load(share + slot * task.stride);
  const Real scale = splat(1.0f) / total;
  for (u32 slot = 0; slot < cell.slot_count; ++slot)
    store(load(share + slot * task.stride) * scale, share + slot * task.stride);
}
