// slice, path -> [PROBE] -> sector, contours, line
import {BufferAttribute, BufferGeometry, Color, DoubleSide, Group, Mesh, MeshBasicMaterial, ShapeUtils, SphereGeometry, Vector2, Vector3} from 'three';
import {Line2} from 'three/addons/lines/Line2.js';
import {LineGeometry} from 'three/addons/lines/LineGeometry.js';
import {LineMaterial} from 'three/addons/lines/LineMaterial.js';
import {LineSegments2} from 'three/addons/lines/LineSegments2.js';
import {LineSegmentsGeometry} from 'three/addons/lines/LineSegmentsGeometry.js';
import {fromBytes} from './colour.js';

/** The current slice: what of its plane was seen, and the contours in it. */
export class Slice {
  constructor() {
    this.group = new Group();
    this.outline = new LineSegments2(new LineSegmentsGeometry(), new LineMaterial({linewidth: 1.5}));
    this.contours = new LineSegments2(new LineSegmentsGeometry(), new LineMaterial({linewidth: 3, vertexColors: true}));
    this.sheet = new Mesh(new BufferGeometry(), new MeshBasicMaterial({
      transparent: true, opacity: 0.13, side: DoubleSide, depthWrite: false}));
    this.sheet.renderOrder = 2;
    this.group.add(this.outline, this.contours, this.sheet);
    for (const part of this.group.children) part.frustumCulled = part.visible = false;
  }

  colour(css) {
    this.outline.material.color = this.sheet.material.color = new Color(css);
  }

  show({contours, view}, points) {
    const ends = [], colours = [];
    for (const loop of contours) {
      const colour = fromBytes(loop.colour);
      for (const p of segments(points, loop)) {
        ends.push(...p);
        colours.push(colour.r, colour.g, colour.b);
      }
    }
    replace(this.contours, ends, colours);
    replace(this.outline, segments(points, view).flat());
    this.sheet.geometry.dispose();
    this.sheet.geometry = fill(points, view);
    this.sheet.visible = view.count > 2;
  }
}

/** Where the probe was; a ball where it is. */
export class Path {
  constructor() {
    this.group = new Group();
    this.points = [];
    this.line = new Line2(new LineGeometry(), new LineMaterial({linewidth: 2.5, transparent: true, opacity: 0.85}));
    this.head = new Mesh(new SphereGeometry(1, 20, 12), new MeshBasicMaterial());
    this.line.frustumCulled = this.line.visible = this.head.visible = false;
    this.group.add(this.line, this.head);
  }

  colour(css) {
    this.line.material.color = this.head.material.color = new Color(css);
  }

  /** @param size_mm  of what is scanned, for the ball */
  extend(again, points, size_mm) {
    if (again) this.points = [];
    this.points.push(...points);
    const count = this.points.length / 3;
    if (points.length === 0 || count === 0) return;
    this.head.position.fromArray(this.points, 3 * (count - 1));
    this.head.scale.setScalar(0.012 * size_mm);
    this.head.visible = true;
    if (count < 2) return;
    this.line.geometry.dispose();
    this.line.geometry = new LineGeometry().setPositions(this.points);
    this.line.visible = true;
  }
}

function segments(points, {first, count}) {
  const at = (i) => [...points.subarray(3 * i, 3 * i + 3)];
  return Array.from({length: count}, (_, i) => [at(first + i), at(first + (i + 1) % count)]).flat();
}

function replace(lines, ends, colours) {
  lines.visible = ends.length > 0;
  if (!lines.visible) return;
  lines.geometry.dispose();
  lines.geometry = new LineSegmentsGeometry().setPositions(ends);
  if (colours) lines.geometry.setColors(colours);
}

/** The inside of a flat loop. */
function fill(points, {first, count}) {
  const corners = Array.from({length: count}, (_, i) => new Vector3().fromArray(points, 3 * (first + i)));
  const normal = new Vector3();
  corners.forEach((p, i) => normal.add(new Vector3().crossVectors(p, corners[(i + 1) % count])));
  const x = new Vector3().subVectors(corners[1] ?? normal, corners[0] ?? normal).normalize();
  const y = new Vector3().crossVectors(normal.normalize(), x);
  const triangles = ShapeUtils.triangulateShape(corners.map((p) => new Vector2(p.dot(x), p.dot(y))), []);
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(corners.flatMap((p) => p.toArray())), 3));
  geometry.setIndex(triangles.flat());
  return geometry;
}
