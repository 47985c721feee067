// two points on the surface -> [MEASURE] -> mm
import {Group, Mesh, MeshBasicMaterial, Raycaster, SphereGeometry, Vector2, Vector3} from 'three';
import {Line2} from 'three/addons/lines/Line2.js';
import {LineGeometry} from 'three/addons/lines/LineGeometry.js';
import {LineMaterial} from 'three/addons/lines/LineMaterial.js';

/** A press that moves farther is a turn of the view. */
const kTap_px = 6;

export class Measure {
  constructor(stage, surfaces, ruler, crosshair) {
    Object.assign(this, {stage, surfaces, ruler, crosshair, active: false, points: []});
    const ball = () => new Mesh(new SphereGeometry(1, 20, 12), new MeshBasicMaterial({depthTest: false}));
    this.balls = [ball(), ball()];
    this.line = new Line2(new LineGeometry(), new LineMaterial({linewidth: 3, depthTest: false}));
    this.line.frustumCulled = false;
    this.group = new Group();
    this.group.add(...this.balls, this.line);
    for (const part of this.group.children) part.renderOrder = 10;
    stage.canvas.addEventListener('pointerdown', (e) => { this.pressed = [e.clientX, e.clientY]; });
    stage.canvas.addEventListener('pointerup', (e) => {
      if (this.active && Math.hypot(e.clientX - this.pressed[0], e.clientY - this.pressed[1]) <= kTap_px) this.#pick(e);
    });
    stage.afterFrame.push(() => this.#place());
    this.toggle(false);
  }

  colour(css) {
    for (const part of this.group.children) part.material.color.set(css);
  }

  toggle(on) {
    this.active = on;
    this.points = [];
    this.#show();
  }

  pickMiddle() {
    this.#add(this.stage.middle());
  }

  #pick({clientX, clientY}) {
    const {left, top, width, height} = this.stage.canvas.getBoundingClientRect();
    this.#add(new Vector2((2 * (clientX - left)) / width - 1, 1 - (2 * (clientY - top)) / height));
  }

  #add(at) {
    const ray = new Raycaster();
    this.stage.camera.updateMatrixWorld();  // it may have moved since the last frame
    ray.setFromCamera(at, this.stage.camera);
    const [hit] = ray.intersectObjects(this.surfaces.group.children.filter((mesh) => mesh.visible), false);
    if (!hit) return;
    if (this.points.length === 2) this.points = [];
    this.points.push(hit.point);
    this.#show();
  }

  #show() {
    const done = this.points.length === 2;
    this.balls.forEach((ball, i) => {
      ball.visible = i < this.points.length;
      if (ball.visible) ball.position.copy(this.points[i]);
    });
    this.line.visible = done;
    if (done) {
      this.line.geometry.dispose();
      this.line.geometry = new LineGeometry().setPositions(this.points.flatMap((p) => p.toArray()));
    }
    this.crosshair.hidden = !this.active;
    this.ruler.hidden = !this.active;
    this.ruler.textContent = done ? `${this.points[0].distanceTo(this.points[1]).toFixed(1)} mm`
                                  : this.points.length === 1 ? 'second point' : 'first point';
    this.stage.invalidate();
  }

  /** The text follows the line; the balls keep their size on the screen. */
  #place() {
    if (!this.active) return;
    const {camera, canvas} = this.stage;
    const middle = new Vector3();
    for (const p of this.points) middle.addScaledVector(p, 1 / this.points.length);
    const centre = this.stage.middle();
    this.crosshair.style.left = `${50 * (1 + centre.x)}%`;
    const at = this.points.length > 0 ? middle.project(camera) : middle.set(centre.x, -0.06, 0);
    const x = ((at.x + 1) / 2) * canvas.clientWidth, y = ((1 - at.y) / 2) * canvas.clientHeight;
    this.ruler.style.translate = `calc(${x}px - 50%) ${y + 12}px`;
    for (const ball of this.balls) ball.scale.setScalar(0.004 * camera.position.distanceTo(ball.position));
  }
}
