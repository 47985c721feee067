// status of the server -> [PANEL] -> words and numbers beside the picture
import {kTold} from './surfaces.js';

const kNumbers = new Intl.NumberFormat('en', {maximumSignificantDigits: 4});

function element(name, attributes = {}, ...children) {
  const made = Object.assign(document.createElement(name), attributes);
  made.append(...children);
  return made;
}

/** A line for every label: whether it is shown, its name, its volume, how opaque it is. */
export class LabelList {
  /** @param change  called with a label and {visible} or {opacity} */
  constructor(list, look, change) {
    Object.assign(this, {list, look, change, lines: new Map()});
  }

  show(labels) {
    const shown = labels.map(({label}) => label).join();
    if (shown !== this.shown) {
      this.shown = shown;
      this.lines = new Map(labels.map((entry) => [entry.label, this.#line(entry)]));
      this.list.replaceChildren(...[...this.lines.values()].map(({item}) => item));
    }
    for (const {label, volume_ml} of labels) {
      const {volume, opacity} = this.lines.get(label);
      volume.textContent = `${kNumbers.format(volume_ml)} ml`;
      if (document.activeElement !== opacity) opacity.value = this.look(label).opacity;
    }
  }

  toggle(index) {
    [...this.lines.values()][index]?.box.click();
  }

  #line({label, name, colour}) {
    const look = this.look(label);
    const box = element('input', {type: 'checkbox', checked: look.visible});
    const volume = element('span', {className: 'volume'});
    const opacity = element('input', {type: 'range', min: 0, max: 1, step: 0.05, value: look.opacity});
    opacity.setAttribute('aria-label', `Opacity of ${name}`);
    box.addEventListener('change', () => this.change(label, {visible: box.checked}));
    opacity.addEventListener('input', () => this.change(label, {opacity: Number(opacity.value)}));
    const item = element('li', {}, element('label', {}, box, element('span', {className: 'name', textContent: name})),
                         volume, opacity);
    item.style.setProperty('--of', `rgb(${colour.join()})`);
    return {item, box, volume, opacity};
  }
}

/** What is recorded, or was, and whether all of it. */
export function showRecording(line, {file, running, seconds, records, not_recorded, failure}) {
  line.hidden = false;
  line.className = running ? 'running' : failure || not_recorded ? 'failed' : '';
  const lost = not_recorded ? [`${not_recorded} not recorded`] : [];
  line.textContent = [running ? `recording ${file}` : file, `${seconds.toFixed(0)} s`, `${records} records`, ...lost,
                      failure].filter(Boolean).join(', ');
}

const kMillimetres = new Intl.NumberFormat('en', {maximumSignificantDigits: 2, style: 'unit', unit: 'millimeter'});

/** What the colours tell, from their low end to the high one. */
export function showRamp(from, to, told, near_mm) {
  const far = `≥ ${kMillimetres.format(4 * near_mm)}`, near = `≤ ${kMillimetres.format(near_mm)}`;
  [from.textContent, to.textContent] = told === kTold.coverage ? [far, near] : ['estimated', 'measured'];
}

/** What the millimetres of the colours are, how much was seen, and how large what is missing is in one piece. */
export function showSeen(line, {volume_ml, seen, gap}) {
  const missing = gap ? `. The disc shows ${kNumbers.format(gap.volume_ml)} ml that no slice came near` : '';
  const all = `${(100 * seen).toFixed(1)} % of ${kNumbers.format(volume_ml)} ml seen`;
  line.textContent = `to the nearest slice. ${all}${missing}.`;
}

const kLedgerNames = {
  made: 'made', delivered: 'delivered', host_dropped: 'dropped by host', crc_bad: 'damaged', malformed: 'malformed',
  transport_lost: 'lost on the way', device_dropped: 'dropped by probe',
};

function fill(list, rows) {
  list.replaceChildren(...rows.flatMap(([name, value]) => [
    element('dt', {textContent: name}), element('dd', {textContent: value})]));
}

export function showFigures(list, head) {
  const rows = [['Triangles', kNumbers.format(head.bricks.triangles)]];
  if (head.slices) {
    const {delivered, inserted, explained, merged, refused, dropped} = head.slices;
    rows.unshift(['Slices', delivered], ['Rate', `${head.rate_hz.toFixed(1)} / s`],
                 ['Latency', `${head.latency_ms.toFixed(0)} ms`], ['Detail', head.detail]);
    rows.push(['New to the mesh', inserted], ['Known already', explained + merged], ['Refused', refused],
              ['Dropped', dropped]);
  }
  fill(list, rows);
}

export function showLedger(list, ledger) {
  fill(list, Object.entries(kLedgerNames).map(([key, name]) => [name, ledger[key]]));
}
