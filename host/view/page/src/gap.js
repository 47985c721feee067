// what was not seen -> [GAP] -> the plane that would show most of it
import {CircleGeometry, DoubleSide, Group, Mesh, MeshBasicMaterial, Vector3} from 'three';
import {Line2} from 'three/addons/lines/Line2.js';
import {LineGeometry} from 'three/addons/lines/LineGeometry.js';
import {LineMaterial} from 'three/addons/lines/LineMaterial.js';

const kAlongZ = new Vector3(0, 0, 1);
const kCorners = 64;

/** A disc as large as the largest gap, where the next slice should lie; it is seen through whatever is in front. */
export class Gap {
  constructor() {
    const corners = Array.from({length: kCorners + 1}, (_, i) => (2 * Math.PI * i) / kCorners);
    const rim = new LineGeometry().setPositions(corners.flatMap((a) => [Math.cos(a), Math.sin(a), 0]));
    const through = {depthTest: false, transparent: true};
    this.group = new Group();
    this.group.add(
        new Mesh(new CircleGeometry(1, kCorners), new MeshBasicMaterial({...through, opacity: 0.25, side: DoubleSide})),
        new Line2(rim, new LineMaterial({...through, linewidth: 3, dashed: true, dashSize: 0.12, gapSize: 0.07})));
    this.group.children[1].computeLineDistances();
    for (const part of this.group.children) part.renderOrder = 5;
    this.show();
  }

  colour(css) {
    for (const part of this.group.children) part.material.color.set(css);
  }

  /** @param gap  as the server says it; none: there is none, or it is not to be shown */
  show(gap) {
    this.group.visible = Boolean(gap);
    if (!gap) return;
    this.group.position.fromArray(gap.centre);
    this.group.quaternion.setFromUnitVectors(kAlongZ, new Vector3().fromArray(gap.normal));
    this.group.scale.setScalar(Math.cbrt((3000 * gap.volume_ml) / (4 * Math.PI)));  // of a ball of its volume
  }
}
