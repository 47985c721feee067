// camera -> [COMPASS] -> where left, front and above are; a press looks from there
import {Vector3} from 'three';

/** LPS: x to the patient's left, y to the back, z upwards. */
export const kSides = {
  L: {name: 'left', at: new Vector3(1, 0, 0)}, R: {name: 'right', at: new Vector3(-1, 0, 0)},
  P: {name: 'back', at: new Vector3(0, 1, 0)}, A: {name: 'front', at: new Vector3(0, -1, 0)},
  S: {name: 'above', at: new Vector3(0, 0, 1)}, I: {name: 'below', at: new Vector3(0, 0, -1)},
};
const kSvg = 'http://www.w3.org/2000/svg';

export class Compass {
  constructor(element, camera, look) {
    this.camera = camera;
    this.element = element;
    const svg = element.appendChild(document.createElementNS(kSvg, 'svg'));
    svg.setAttribute('viewBox', '-50 -50 100 100');
    svg.setAttribute('aria-hidden', 'true');
    this.marks = Object.entries(kSides).map(([letter, {name, at}]) => {
      const line = svg.appendChild(document.createElementNS(kSvg, 'line'));
      const button = element.appendChild(document.createElement('button'));
      button.textContent = letter;
      button.setAttribute('aria-label', `from ${name}`);
      button.title = `Look from ${name}`;
      button.addEventListener('click', () => look(letter));
      return {line, button, at};
    });
  }

  draw() {
    const radius = this.element.clientWidth / 2 - 13;
    for (const {line, button, at} of this.marks) {
      const p = at.clone().transformDirection(this.camera.matrixWorldInverse);
      line.setAttribute('x2', 38 * p.x);
      line.setAttribute('y2', -38 * p.y);
      line.style.opacity = button.style.opacity = 0.35 + 0.65 * (p.z + 1) / 2;
      button.style.translate = `${radius * p.x}px ${-radius * p.y}px`;
      button.style.zIndex = Math.round(10 + 9 * p.z);
    }
  }
}
