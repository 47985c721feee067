// surfaces, probe -> [STAGE] -> canvas; draws when something changed, and not else
import {AmbientLight, Box3, Color, DirectionalLight, HemisphereLight, NeutralToneMapping, PerspectiveCamera, Scene, Sphere, Vector2, Vector3, WebGLRenderer} from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';

const kFirstLook = new Vector3(0.55, -0.75, 0.38);  // from the left front, a little above

export class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({canvas, antialias: true, alpha: true});
    this.renderer.toneMapping = NeutralToneMapping;
    this.renderer.toneMappingExposure = 1.15;
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(30, 1, 1, 10000);
    this.camera.up.set(0, 0, 1);  // S is above
    this.camera.position.copy(kFirstLook).multiplyScalar(500);
    this.#light();
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.covered = 0;
    this.framed = true;  // nobody has chosen a view: it follows what is there
    this.controls.addEventListener('start', () => { this.framed = false; });
    this.controls.addEventListener('change', () => this.invalidate());
    this.afterFrame = [];
    new ResizeObserver(() => this.#fit()).observe(canvas.parentElement);
    this.#fit();
  }

  add(...groups) {
    this.scene.add(...groups);
  }

  invalidate() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.draw();
    });
  }

  draw() {
    this.renderer.render(this.scene, this.camera);
    for (const call of [...this.afterFrame]) call();
  }

  /** @param right_px  of the canvas that something covers: the middle of the picture moves out from under it */
  cover(right_px) {
    this.covered = right_px;
    this.#fit();
  }

  /** Of what is not covered, in the canvas's coordinates of -1..1. */
  middle() {
    return new Vector2(-this.covered / this.canvas.clientWidth, 0);
  }

  /** Moves back or nearer until the box fills the view. */
  frame(box, look = this.camera.position.clone().sub(this.controls.target)) {
    if (box.isEmpty()) return;
    const sphere = box.getBoundingSphere(new Sphere());
    const {clientWidth, clientHeight} = this.canvas;
    const half = Math.min(1, (clientWidth - this.covered) / clientHeight) * Math.tan((this.camera.fov * Math.PI) / 360);
    const distance = (0.92 * sphere.radius) / Math.sin(Math.atan(half));
    this.controls.target.copy(sphere.center);
    this.camera.position.copy(sphere.center).addScaledVector(look.normalize(), distance);
    this.camera.near = distance / 100;
    this.camera.far = distance * 20;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.invalidate();
  }

  /** Frames what grows, as long as nobody chose a view, in steps rather than all the time. */
  follow(box) {
    if (!this.framed || box.isEmpty()) return;
    const grown = this.followed?.clone().expandByScalar(0.04 * this.followed.getSize(new Vector3()).length());
    if (grown?.containsBox(box)) return;
    this.followed = box.clone();
    this.frame(new Box3().copy(box));
  }

  /** @param across, up  radians */
  turn(across, up) {
    this.framed = false;
    const arm = this.camera.position.clone().sub(this.controls.target);
    const length = arm.length();
    const around = Math.atan2(arm.y, arm.x) + across;
    const above = Math.max(-1.56, Math.min(1.56, Math.asin(arm.z / length) + up));
    arm.set(Math.cos(above) * Math.cos(around), Math.cos(above) * Math.sin(around), Math.sin(above)).multiplyScalar(length);
    this.camera.position.copy(this.controls.target).add(arm);
    this.controls.update();
    this.invalidate();
  }

  /** @param right, up  shares of the distance */
  shift(right, up) {
    this.framed = false;
    const distance = this.camera.position.distanceTo(this.controls.target);
    const step = new Vector3(right, up, 0).multiplyScalar(distance).applyQuaternion(this.camera.quaternion);
    this.controls.target.add(step);
    this.camera.position.add(step);
    this.controls.update();
    this.invalidate();
  }

  nearer(factor) {
    this.framed = false;
    this.camera.position.lerp(this.controls.target, 1 - factor);
    this.controls.update();
    this.invalidate();
  }

  lookFrom(direction, box) {
    // Straight from above or below there is no "up": a trace of the front gives the picture its usual turn.
    this.frame(box, direction.clone().add(new Vector3(0, -0.001, 0)));
    this.framed = false;
  }

  /** What the canvas shows, on the page's background. @returns a promise of a PNG */
  picture() {
    this.draw();  // what was drawn before is gone from the buffer
    const copy = document.createElement('canvas');
    copy.width = this.canvas.width;
    copy.height = this.canvas.height;
    const pen = copy.getContext('2d');
    const style = getComputedStyle(document.documentElement);
    const sky = pen.createRadialGradient(copy.width / 2, copy.height / 5, 0, copy.width / 2, copy.height / 5,
                                         1.2 * Math.max(copy.width, copy.height));
    sky.addColorStop(0, style.getPropertyValue('--sky'));
    sky.addColorStop(1, style.getPropertyValue('--ground'));
    pen.fillStyle = sky;
    pen.fillRect(0, 0, copy.width, copy.height);
    pen.drawImage(this.canvas, 0, 0);
    return new Promise((done) => { copy.toBlob(done, 'image/png'); });
  }

  #light() {
    const beside = (light, x, y, z) => {
      light.position.set(x, y, z);
      this.camera.add(light, light.target);  // moves with the eye: no side is ever dark
    };
    const key = new DirectionalLight(0xfff6ec, 2.3), fill = new DirectionalLight(0xdcecff, 0.7);
    beside(key, -0.7, 1, 1);
    beside(fill, 1, -0.3, 0.6);
    key.target.position.set(0, 0, 0);
    const sky = new HemisphereLight(0xffffff, 0xb8c4d0, 1.1);
    sky.position.set(0, 0, 1);
    this.scene.add(this.camera, sky, new AmbientLight(new Color(0xffffff), 0.25));
  }

  #fit() {
    const {clientWidth, clientHeight} = this.canvas.parentElement;
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / Math.max(1, clientHeight);
    this.camera.setViewOffset(clientWidth, clientHeight, this.covered / 2, 0, clientWidth, clientHeight);
    if (this.framed && this.followed) this.frame(this.followed);
    this.invalidate();
  }
}
