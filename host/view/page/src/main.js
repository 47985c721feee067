// What is on the page, joined:  link -> surfaces, slice, path -> stage; keys and buttons -> all of them
import {Vector3} from 'three';
import {Compass, kSides} from './compass.js';
import {Gap} from './gap.js';
import {Link} from './link.js';
import {Measure} from './measure.js';
import {LabelList, showFigures, showLedger, showRamp, showRecording, showSeen} from './panel.js';
import {Path, Slice} from './probe.js';
import {Stage} from './stage.js';
import {kTold, Surfaces} from './surfaces.js';

/** How often a page asks what was seen while it shows it. */
const kCoverage_ms = 1000;

const $ = (id) => document.getElementById(id);
const stage = new Stage($('canvas'));
const surfaces = new Surfaces(), slice = new Slice(), probePath = new Path(), gap = new Gap();
const measure = new Measure(stage, surfaces, $('ruler'), $('crosshair'));
stage.add(surfaces.group, slice.group, probePath.group, gap.group, measure.group);

/** What the page holds, for whoever wants to check it against what the server says it sent. */
const counts = {messages: 0, bricksReceived: 0, bricksSent: 0, bricks: 0, faces: 0, serverBricks: 0, serverFaces: 0};
window.sonoloft = {counts, camera: stage.camera, gap: gap.group};

function noteFirstMesh() {
  counts.firstMeshAt = Date.now();
  stage.afterFrame.splice(stage.afterFrame.indexOf(noteFirstMesh), 1);
}

function colourLines() {
  const style = getComputedStyle(document.documentElement);
  slice.colour(style.getPropertyValue('--sector'));
  probePath.colour(style.getPropertyValue('--path'));
  measure.colour(style.getPropertyValue('--accent'));
  gap.colour(style.getPropertyValue('--warn'));
  stage.invalidate();
}
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', colourLines);
colourLines();

const narrow = matchMedia('(max-width: 720px)');
function arrange() {
  $('figures-box').open = !narrow.matches;
  stage.cover(narrow.matches ? 0 : $('panel').clientWidth);
}
narrow.addEventListener('change', arrange);
arrange();

const look = (letter) => stage.lookFrom(kSides[letter].at, surfaces.box());
const compass = new Compass($('compass'), stage.camera, look);
stage.afterFrame.push(() => compass.draw());

const labels = new LabelList($('labels'), (label) => surfaces.look(label), (label, change) => {
  surfaces.choose(label, change);
  stage.invalidate();
});

function take({head, path, slice: slicePoints, bricks}) {
  surfaces.apply(bricks);
  surfaces.dress(head.labels ?? []);
  const box = surfaces.box();
  probePath.extend(head.path.again, path, box.isEmpty() ? 100 : box.getSize(new Vector3()).length());
  if (head.slice) slice.show(head.slice, slicePoints);
  if (surfaces.bricks > 0 && !counts.firstMeshAt) stage.afterFrame.push(noteFirstMesh);
  stage.follow(box);
  stage.invalidate();
  labels.show(head.labels ?? []);
  showFigures($('figures'), head);
  $('ledger-box').hidden = !head.ledger;
  if (head.ledger) showLedger($('ledger'), head.ledger);
  if ($('state').textContent !== head.state) $('state').textContent = head.state;  // is read aloud when it changes
  $('empty').hidden = surfaces.bricks > 0;
  $('stop').hidden = !head.stop;
  $('record').hidden = !head.record;
  $('record').setAttribute('aria-pressed', Boolean(head.recording?.running));
  if (head.recording) showRecording($('recording'), head.recording);
  $('measured').hidden = !head.measured;
  $('coverage').hidden = !head.measured || !head.cover;
  if (head.coverage) showCoverage(head.coverage);
  $('slice').hidden = $('path').hidden = !head.slices;
  counts.messages += 1;
  counts.bricksReceived += bricks.length;
  Object.assign(counts, {bricksSent: head.bricks.sent, serverBricks: head.bricks.all, serverFaces: head.bricks.faces,
                         bricks: surfaces.bricks, faces: surfaces.faces, more: head.bricks.more});
}

const link = new Link(take, (state) => {
  $('state').className = state === 'open' ? 'live' : 'gone';
  $('state').textContent = state === 'open' ? 'connected' : 'no connection: the program has ended, or refuses this page';
  if (state !== 'open') return;
  surfaces.clear();  // the server sends all there is
  counts.bricksReceived = 0;
  if (surfaces.told !== kTold.label) link.say('measured');
});

function askCoverage() {
  if (surfaces.told === kTold.coverage) link.say('coverage');
}
setInterval(askCoverage, kCoverage_ms);

function showCoverage(coverage) {
  if (surfaces.told !== kTold.coverage) return;
  surfaces.near_mm.value = coverage.near_mm;
  showRamp($('ramp-from'), $('ramp-to'), surfaces.told, coverage.near_mm);
  showSeen($('seen'), coverage);
  $('seen').hidden = false;
  gap.show(coverage.gap);
}

function press(id) {
  const on = $(id).getAttribute('aria-pressed') !== 'true';
  $(id).setAttribute('aria-pressed', on);
  return on;
}

/** Colours tell what the button says, or the labels again. */
function tell(id, what) {
  const told = press(id) ? what : kTold.label;
  for (const other of ['measured', 'coverage']) if (other !== id) $(other).setAttribute('aria-pressed', false);
  if ((told === kTold.label) !== (surfaces.told === kTold.label)) link.say(told === kTold.label ? 'labels' : 'measured');
  surfaces.tell(told);
  $('ramp').hidden = told === kTold.label;
  showRamp($('ramp-from'), $('ramp-to'), told, surfaces.near_mm.value);
  $('seen').hidden = true;
  gap.show();
  askCoverage();
}

const actions = {
  frame: () => stage.frame(surfaces.box()),
  slice: () => { slice.group.visible = press('slice'); },
  path: () => { probePath.group.visible = press('path'); },
  measured: () => tell('measured', kTold.confidence),
  coverage: () => tell('coverage', kTold.coverage),
  measure: () => {
    measure.toggle(press('measure'));
    $('stage').focus();  // where Enter takes a point
  },
  picture: async () => {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(await stage.picture());
    link.download = `sonoloft-${new Date().toISOString().slice(0, 19).replace(/[:T]/g, '-')}.png`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60000);
  },
  keys: () => $('help').showModal(),
  record: () => link.say($('record').getAttribute('aria-pressed') === 'true' ? 'record-end' : 'record'),
  stop: () => link.say('stop'),
};
for (const [id, act] of Object.entries(actions)) {
  $(id).addEventListener('click', () => {
    act();
    stage.invalidate();
  });
}

const kStep = Math.PI / 24;
const arrows = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
const keys = {
  f: 'frame', v: 'slice', t: 'path', c: 'measured', g: 'coverage', m: 'measure', p: 'picture', e: 'record', '?': 'keys',
};
const sides = {l: 'L', r: 'R', a: 'A', o: 'P', s: 'S', i: 'I'};

document.addEventListener('keydown', (event) => {
  const {key, shiftKey, target} = event;
  if (event.ctrlKey || event.metaKey || event.altKey || $('help').open || target.type === 'range') return;
  const small = key.toLowerCase();
  if (arrows[key]) {
    const [across, up] = arrows[key];
    if (shiftKey) stage.shift(0.06 * across, 0.06 * up);
    else stage.turn(kStep * across, kStep * up);
  } else if (key === '+' || key === '=' || key === '-') {
    stage.nearer(key === '-' ? 1.15 : 1 / 1.15);
  } else if (key === 'Enter' && measure.active && target.tagName !== 'BUTTON') {
    measure.pickMiddle();
  } else if (key === 'Escape' && measure.active) {
    $('measure').click();
  } else if (keys[small] && !$(keys[small]).hidden) {
    $(keys[small]).click();
  } else if (sides[small]) {
    look(sides[small]);
  } else if (/^[1-9]$/.test(key)) {
    labels.toggle(Number(key) - 1);
  } else {
    return;
  }
  event.preventDefault();
});
