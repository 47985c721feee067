// bytes of the server -> [MESSAGE] -> what is new; docs/viewer.md has the layout.

/** @returns {{head: object, path: Float32Array, slice: Float32Array, bricks: object[]}} */
export function decode(buffer) {
  const view = new DataView(buffer);
  const headBytes = view.getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, headBytes)));
  const reader = new Reader(buffer, view, 4 + headBytes);
  const path = reader.floats(3 * head.path.points);
  const slice = reader.floats(3 * (head.slice?.points ?? 0));
  const bricks = Array.from({length: head.bricks.here}, () => readBrick(reader));
  return {head, path, slice, bricks};
}

class Reader {
  constructor(buffer, view, at) {
    Object.assign(this, {buffer, view, at});
  }
  int() {
    this.at += 4;
    return this.view.getInt32(this.at - 4, true);
  }
  floats(count) {
    return this.#take(Float32Array, count);
  }
  bytes(count) {
    return this.#take(Int8Array, count);
  }
  distances(count) {
    return this.#take(Uint8Array, 4 * Math.ceil(count / 4)).subarray(0, count);
  }
  indices(count) {
    return this.#take(Uint32Array, count);
  }
  #take(Type, count) {
    const taken = new Type(this.buffer, this.at, count);
    this.at += taken.byteLength;
    return taken;
  }
}

function readBrick(reader) {
  const coord = [reader.int(), reader.int(), reader.int()];
  const surfaces = new Map();
  for (let labels = reader.int(); labels > 0; --labels) {
    const label = reader.int(), vertices = reader.int(), indices = reader.int();
    // Copies: views would keep the whole message alive.
    surfaces.set(label, {
      positions: reader.floats(3 * vertices).slice(),
      shades: reader.bytes(4 * vertices).slice(),
      distances: reader.distances(vertices).slice(),
      indices: reader.indices(indices).slice(),
    });
  }
  return {coord, surfaces};
}
