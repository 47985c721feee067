// Drives the page in a headless Chromium and writes what it saw as JSON; the test that starts it judges.
//   node drive_page.mjs MODULES URL SCENARIO FOLDER [SECONDS]
import {writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';

const [modules, url, scenario, folder, seconds] = process.argv.slice(2);
const {chromium} = createRequire(`${modules}/`)('playwright-core');
const browser = await chromium.launch({
  executablePath: '/usr/bin/chromium',
  args: ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--enable-precise-memory-info', '--no-first-run',
         '--disable-background-networking', '--disable-component-update', '--disable-sync', '--disable-quic',
         ...(process.getuid() === 0 ? ['--no-sandbox'] : [])],
});
const errors = [];
const desktop = {width: 1280, height: 800}, phone = {width: 390, height: 844};

async function open(viewport, colorScheme, more = {}) {
  const page = await (await browser.newContext({viewport, colorScheme, ...more})).newPage();
  page.setDefaultTimeout(120000);
  page.on('console', (message) => { if (message.type() === 'error') errors.push(message.text()); });
  page.on('pageerror', (error) => errors.push(String(error)));
  await page.goto(url);
  return page;
}
const counts = (page) => page.evaluate(() => window.sonoloft.counts);
const over = (page) => page.waitForFunction(
    () => document.getElementById('state').textContent === 'the scan is over' && window.sonoloft.counts.more === false);
const shot = (page, name) => page.screenshot({path: `${folder}/${name}.png`});
const eye = (page) => page.evaluate(() => window.sonoloft.camera.position.toArray().map(Math.round).join());
const pressed = (page, id) => page.getAttribute(`#${id}`, 'aria-pressed');

/** What was not seen, as the page tells it, once all of it is there. */
async function coverage(page, name) {
  await page.waitForFunction(() => !document.getElementById('seen').hidden && !window.sonoloft.counts.more);
  await shot(page, name);
  const disc = await page.evaluate(() => {
    const {visible, position, scale} = window.sonoloft.gap;
    return {visible, position: position.toArray(), radius: scale.x};
  });
  return {disc, text: await page.textContent('#seen'), far: await page.textContent('#ramp-from')};
}

/** What each key does, told by what can be seen of it. */
async function keyboard(page) {
  const seen = {};
  const changes = async (name, look, ...keys) => {
    const before = await look();
    for (const key of keys) await page.keyboard.press(key);
    seen[name] = before !== (await look());
  };
  for (const key of ['ArrowLeft', 'ArrowUp', 'Shift+ArrowRight', '+', 'f', 'a']) await changes(key, () => eye(page), key);
  for (const [key, id] of [['v', 'slice'], ['t', 'path'], ['c', 'measured'], ['g', 'coverage'], ['m', 'measure']])
    await changes(key, () => pressed(page, id), key);
  seen['g instead of c'] = (await pressed(page, 'measured')) === 'false';
  report.coverage = await coverage(page, 'desktop-light-coverage');
  await changes('c instead of g', () => page.evaluate(() => window.sonoloft.gap.visible), 'c');
  seen.first = await page.textContent('#ruler');
  await page.keyboard.press('Enter');
  seen.second = await page.textContent('#ruler');
  for (const key of ['ArrowLeft', 'ArrowLeft', 'Enter']) await page.keyboard.press(key);
  seen.distance = await page.textContent('#ruler');
  await changes('Escape', () => pressed(page, 'measure'), 'Escape');
  await changes('1', () => page.locator('#labels input[type=checkbox]').first().isChecked(), '1');
  await page.keyboard.press('1');
  await changes('?', () => page.locator('#help').isVisible(), '?');
  await shot(page, 'desktop-light-keys');
  await changes('close', () => page.locator('#help').isVisible(), 'Enter');
  const [download] = await Promise.all([page.waitForEvent('download'), page.keyboard.press('p')]);
  await download.saveAs(`${folder}/picture.png`);
  seen.picture = download.suggestedFilename();
  await page.focus('#labels input[type=range]');
  await changes('opacity', () => page.locator('#labels input[type=range]').first().inputValue(), 'ArrowLeft', 'ArrowLeft');
  return seen;
}

/** What Tab comes by, and the names that a screen reader says. */
async function names(page) {
  await page.focus('#stage');
  const found = [];
  for (let i = 0; i < 60; ++i) {
    await page.keyboard.press('Tab');
    found.push(await page.evaluate(() => {
      const at = document.activeElement;
      const label = at.getAttribute('aria-label') ?? (at.labels?.[0] ?? at).textContent.trim();
      return at === document.body ? '' : `${at.tagName} ${label}`;
    }));
  }
  return [...new Set(found)].filter(Boolean);
}

const report = {errors};
if (scenario === 'scan') {
  const first = await open(desktop, 'light', {acceptDownloads: true});
  await over(first);
  report.first = await counts(first);
  await shot(first, 'desktop-light');
  const late = [await open(desktop, 'dark'), await open(phone, 'light', {hasTouch: true, isMobile: true}),
                await open(phone, 'dark', {hasTouch: true, isMobile: true})];
  for (const page of late) await over(page);
  report.late = await Promise.all(late.map(counts));
  await Promise.all(['desktop-dark', 'phone-light', 'phone-dark'].map((name, i) => shot(late[i], name)));
  await late[2].tap('#coverage');
  report.touched = await coverage(late[2], 'phone-dark-coverage');
  report.names = await names(first);
  report.keys = await keyboard(first);
  await first.waitForFunction(() => !window.sonoloft.counts.more);
  await shot(first, 'desktop-light-measured');
  await first.focus('#stop');
  await first.keyboard.press('Enter');
  await first.waitForFunction(() => document.getElementById('state').textContent === 'stopped');
} else if (scenario === 'record') {
  const page = await open(desktop, 'light'), phone_page = await open(phone, 'dark', {hasTouch: true, isMobile: true});
  const all = (text) => Promise.all([page, phone_page].map((p) => p.waitForFunction(
      (t) => new RegExp(t).test(document.getElementById('recording').textContent), text)));
  await page.waitForFunction(() => !document.getElementById('record').hidden);
  report.before = await pressed(page, 'record');
  await page.keyboard.press('e');
  await all('^recording recording-1.mcap, [0-9]+ s, [0-9]{2,} records$');
  report.during = [await pressed(page, 'record'), await pressed(phone_page, 'record')];
  await shot(page, 'desktop-light-recording');
  await shot(phone_page, 'phone-dark-recording');
  await phone_page.focus('#record');
  await phone_page.keyboard.press('Enter');
  await all('^recording-1.mcap, [0-9]+ s, [0-9]+ records$');
  report.after = await pressed(page, 'record');
  report.errors = [...errors];  // that the program may be gone after this is none
  await page.click('#stop');
  await page.waitForFunction(() => document.getElementById('state').textContent !== 'scanning');
} else {
  const page = await open(desktop, 'light'), frozen = await open(desktop, 'light');
  await frozen.waitForFunction(() => window.sonoloft.counts.bricks > 0);
  const stuck = frozen.evaluate((ms) => { for (const end = Date.now() + ms; Date.now() < end;); }, 1000 * seconds);
  const heap = async () => {
    const session = await page.context().newCDPSession(page);
    await session.send('HeapProfiler.collectGarbage');
    return (await session.send('Runtime.getHeapUsage')).usedSize / 2 ** 20;
  };
  report.before = await counts(page);
  report.heap_mib = [];
  for (let i = 0; i <= 10; ++i) {
    if (i > 0) await page.waitForTimeout(100 * seconds);
    report.heap_mib.push(await heap());
  }
  report.page = await counts(page);
  await stuck;
  await frozen.waitForFunction((m) => window.sonoloft.counts.messages > m, (await counts(frozen)).messages);
  report.frozen = await counts(frozen);
}
writeFileSync(`${folder}/${scenario}.json`, JSON.stringify(report, null, 1));
await browser.close();
