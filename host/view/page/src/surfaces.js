// bricks -> [SURFACES] -> a few meshes a label
import {BufferAttribute, BufferGeometry, Box3, Group, InterleavedBuffer, InterleavedBufferAttribute, Mesh} from 'three';
import {fromBytes} from './colour.js';
import {makeSkin} from './skin.js';

/** Bricks along an edge of a block: one mesh a block and label, so that many bricks are few draw calls. */
const kBlock = 4;
/** What the colour of a surface tells. */
export const kTold = {label: 0, confidence: 1, coverage: 2};
/** The enclosing one of several labels begins as glass, so that what it holds is seen. */
const kGlass = 0.3;

export class Surfaces {
  constructor() {
    this.group = new Group();
    this.blocks = new Map();  // "x,y,z" -> {bricks: Map of "x,y,z" -> surfaces, meshes: Map of label -> Mesh}
    this.looks = new Map();   // label -> {skin, visible, opacity, chosen}
    this.bricks = 0;
    this.faces = 0;
    this.told = kTold.label;
    this.near_mm = {value: 5};
  }

  clear() {
    for (const block of this.blocks.values()) for (const mesh of block.meshes.values()) this.#drop(mesh);
    this.blocks.clear();
    this.bricks = this.faces = 0;
  }

  /** Puts bricks in the place of those that were there. */
  apply(bricks) {
    const dirty = new Map();  // block -> labels
    for (const {coord, surfaces} of bricks) {
      const block = this.#blockAt(coord.map((c) => Math.floor(c / kBlock)).join());
      const key = coord.join();
      const before = block.bricks.get(key);
      if (!dirty.has(block)) dirty.set(block, new Set());
      for (const label of [...(before?.keys() ?? []), ...surfaces.keys()]) dirty.get(block).add(label);
      this.#count(before, -1);
      this.#count(surfaces, 1);
      if (surfaces.size > 0) block.bricks.set(key, surfaces);
      else block.bricks.delete(key);
    }
    for (const [block, labels] of dirty) for (const label of labels) this.#rebuild(block, label);
  }

  /** @param labels  as the server lists them */
  dress(labels) {
    const largest = labels.reduce((a, b) => (b.volume_ml > a.volume_ml ? b : a), labels[0]);
    for (const {label, colour} of labels) {
      const look = this.look(label);
      look.skin.color = fromBytes(colour);
      if (!look.chosen) look.opacity = labels.length > 1 && label === largest.label ? kGlass : 1;
      this.#wear(label);
    }
  }

  look(label) {
    if (!this.looks.has(label)) {
      const skin = makeSkin(this.near_mm);
      skin.userData.told.value = this.told;
      this.looks.set(label, {skin, visible: true, opacity: 1, chosen: false});
    }
    return this.looks.get(label);
  }

  choose(label, change) {
    Object.assign(this.look(label), change, 'opacity' in change ? {chosen: true} : {});
    this.#wear(label);
  }

  tell(told) {
    this.told = told;
    for (const {skin} of this.looks.values()) skin.userData.told.value = told;
  }

  box() {
    const box = new Box3();
    for (const mesh of this.group.children) box.union(mesh.geometry.boundingBox);
    return box;
  }

  #blockAt(key) {
    if (!this.blocks.has(key)) this.blocks.set(key, {bricks: new Map(), meshes: new Map()});
    return this.blocks.get(key);
  }

  #count(surfaces, sign) {
    if (!surfaces || surfaces.size === 0) return;
    this.bricks += sign;
    for (const {indices} of surfaces.values()) this.faces += (sign * indices.length) / 3;
  }

  #rebuild(block, label) {
    const old = block.meshes.get(label);
    if (old) this.#drop(old);
    block.meshes.delete(label);
    const parts = [...block.bricks.values()].map((surfaces) => surfaces.get(label)).filter(Boolean);
    if (parts.length === 0) return;
    const {skin, visible} = this.look(label);
    const mesh = new Mesh(joined(parts), skin);
    mesh.visible = visible;
    mesh.userData.label = label;
    block.meshes.set(label, mesh);
    this.group.add(mesh);
  }

  #drop(mesh) {
    this.group.remove(mesh);
    mesh.geometry.dispose();
  }

  #wear(label) {
    const {skin, visible, opacity} = this.look(label);
    const glass = opacity < 1;
    if (skin.transparent !== glass) {
      skin.transparent = glass;
      skin.depthWrite = !glass;
      skin.needsUpdate = true;
    }
    skin.opacity = opacity;
    for (const mesh of this.group.children) if (mesh.userData.label === label) mesh.visible = visible && opacity > 0;
  }
}

function joined(parts) {
  const sum = (name) => parts.reduce((total, part) => total + part[name].length, 0);
  const positions = new Float32Array(sum('positions')), shades = new Int8Array(sum('shades'));
  const indices = new Uint32Array(sum('indices')), distances = new Uint8Array(sum('distances'));
  let vertex = 0, index = 0;
  for (const part of parts) {
    positions.set(part.positions, 3 * vertex);
    shades.set(part.shades, 4 * vertex);
    distances.set(part.distances, vertex);
    for (const i of part.indices) indices[index++] = vertex + i;
    vertex += part.distances.length;
  }
  const geometry = new BufferGeometry();
  const shade = new InterleavedBuffer(shades, 4);
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setAttribute('normal', new InterleavedBufferAttribute(shade, 3, 0, true));
  geometry.setAttribute('measured', new InterleavedBufferAttribute(shade, 1, 3, true));
  geometry.setAttribute('quarters', new BufferAttribute(distances, 1));
  geometry.setIndex(new BufferAttribute(indices, 1));
  geometry.computeBoundingBox();
  geometry.computeBoundingSphere();
  return geometry;
}
