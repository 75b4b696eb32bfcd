// The status page in a browser, beside the gateway with four simulated drives. GATEWAY_BIN is the program. Screenshots
// go to PAGE_SHOTS, if that is set.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { Demo, demoSite, expectAccessible, openBrowser, openPage, until } from './support.mjs';

const shots = process.env.PAGE_SHOTS;
const wide = { viewport: { width: 1280, height: 800 } };
const phone = { viewport: { width: 390, height: 844 }, isMobile: true, hasTouch: true };
const MOST_BYTES = 60000;
let demo;
let browser;
let page;
let notes;

const card = (name) => page.locator(`#drive-${name}`);
const value = (drive, signal) => card(drive).locator('dl.values > div', { has: page.locator(`dt:text-is("${signal}")`) })
  .locator('.value').textContent();
const notesOf = (drive) => card(drive).locator('.notes').textContent();
const open = (name) => card(name).locator('summary').click();
const badge = (drive) => card(drive).locator('summary .badge').textContent();
// Of one drive and kind: where the machine is busy there may be others, of late values.
const alarms = (of, drive, kind) => of.locator('#alarm-list > li').filter({ has: of.getByText(drive, { exact: true }) })
  .filter({ has: of.getByText(kind, { exact: true }) });
const announced = () => page.locator('#announcer').textContent();
const shot = (of, name) => shots && of.screenshot({ path: path.join(shots, `${name}.png`) });

before(async () => {
  if (shots) {
    fs.mkdirSync(shots, { recursive: true });
  }
  demo = await Demo.start(demoSite);
  await until('all drives are online', async () => (await demo.get('health')).drives_online === 4);
  browser = await openBrowser();
  ({ page, notes } = await openPage(browser, demo.url, wide));
});

after(async () => {
  await browser?.close();
  await demo?.end();
});

test('it shows the plant', async () => {
  await until('it is live', async () => await page.locator('#link').textContent() === 'live');
  await until('all drives are shown', async () => await page.locator('#drive-list > li').count() === 4);
  await until('their state', async () => await badge('pump1') === 'stopped');
  assert.equal(await page.locator('h1').textContent(), 'demo-demo');
  assert.equal(await page.locator('#summary').textContent(), '4 of 4 drives online');
  assert.match(await page.locator('#bus-rows tr').innerText(), /demo\s+virtual\s+active\s+\d+\.\d %/);
  assert.match(await page.locator('#client-lists').innerText(), /no connection/);
  assert.equal(await page.locator('#no-alarm').textContent(), 'No alarm is active.', 'hidden or not');
  assert.equal(await notesOf('pump1'), 'commanded: nothing');
  assert.equal(await page.locator('#drive-list .body').count(), 0, 'all are seen at a glance');
  for (const name of ['pump1', 'hoist1', 'fan1']) {
    await open(name);
  }
});

test('values move, and the command is told with its writer and outcome', async () => {
  await demo.command('set', 'pump1', 'frequency_command=30', 'torque_command=0', 'control_command=forward');
  await until('it runs', async () => await badge('pump1') === 'running');
  const early = Number(await value('pump1', 'output_frequency'));
  await until('it runs faster', async () => Number(await value('pump1', 'output_frequency')) > early + 1);
  assert.match(await value('pump1', 'output_frequency'), /^\d+\.\d\d$/, 'with the decimals of its scale');
  await page.locator('#commands').scrollIntoViewIfNeeded();
  const row = page.locator('#command-rows tr').first();
  await until('the command is told', async () => await row.count() === 1 && /ok/.test(await row.innerText()));
  assert.match(await row.innerText(), /pump1\s+local \S+\s+.*frequency_command 30.*control_command 1.*\s+ok\s+\d+ ms/);
});

test('trend lines are drawn', { skip: !fs.existsSync('/usr/share/javascript/dygraphs') }, async () => {
  await until('six of pump1', async () => await card('pump1').locator('.chart canvas').count() === 12);  // two each
  assert.match(await card('pump1').locator('.chart').first().getAttribute('aria-label'),
    /^pump1: output_frequency of the last ten minutes, /);
});

test('an alarm appears with first-out, and clears', async () => {
  demo.order('5 fault 5');
  await until('it is there', async () => await alarms(page, 'pump1', 'emcy').count() === 1);
  assert.match(await alarms(page, 'pump1', 'emcy').innerText(), /^fault\s+first\s+pump1\s+emcy\s+0x0005: Overcurrent during acceleration\s+since /);
  assert.match(await announced(), /Alarm: pump1, 0x0005: Overcurrent during acceleration, came first/);
  await until('the drive says so', async () => await badge('pump1') === 'fault');
  assert.match(await notesOf('pump1'), /^0x0005: Overcurrent during acceleration/);
  await until('the record is there', async () => await alarms(page, 'pump1', 'emcy').locator('a.record').isVisible(), 30);
  const link = await alarms(page, 'pump1', 'emcy').locator('a.record').getAttribute('href');
  assert.match(await (await fetch(new URL(link, demo.url))).text(), /^\(\d+\.\d{6}\) \S+ \d{3}#/);
  assert.match(await page.title(), /^\(\d+\) demo/);
  await expectAccessible(page, 'with an alarm');
  await page.evaluate(() => scrollTo({ top: 0, behavior: 'instant' }));
  await shot(page, 'light');
  demo.order('5 clear');
  await until('it is over', async () => await alarms(page, 'pump1', 'emcy').count() === 0);
  assert.match(await announced(), /Over: pump1, 0x0005/);
});

test('a drive goes offline: its values are gone and grey', async () => {
  await until('it has values', async () => await value('hoist1', 'output_frequency') === '0.00');
  demo.order('7 unplug on');
  await until('it is offline', async () => await badge('hoist1') === 'offline');
  await until('its values are gone', async () => await value('hoist1', 'output_frequency') === '—');
  const colours = await card('hoist1').locator('dl.values .value').first().evaluate((node) =>
    [getComputedStyle(node).color, getComputedStyle(document.querySelector('.quiet')).color]);
  assert.equal(colours[0], colours[1]);
  await until('its alarm is shown', async () => await alarms(page, 'hoist1', 'heartbeat').count() === 1);
  assert.equal(await value('fan1', 'output_frequency'), '0.00', 'others keep theirs');
  await expectAccessible(page, 'with a drive offline');
});

test('the frames of a drive are shown in words, while somebody wants them', async () => {
  const rows = page.locator('#trace-rows tr');
  assert.equal(await rows.count(), 0);
  await page.locator('#trace-drive').selectOption('pump1');
  await page.locator('#trace-run').click();
  await until('frames come', async () => await rows.count() > 5);
  const pdo = rows.filter({ has: page.locator('td:text-is("TPDO1")') }).first();
  assert.match(await pdo.innerText(), /^\d\d:\d\d:\d\d\.\d{6}\s+185\s+TPDO1\s+status_word 0x.*output_frequency \d+\.\d\d Hz/);
  await page.locator('#trace-kind').selectOption('sdo');
  await until('it begins anew', async () => await rows.count() === 0);
  await demo.command('sdo', 'read', 'pump1', '0x2021:02');
  await until('our request and its answer', async () => await rows.count() === 2);
  assert.match(await rows.last().innerText(), /605\s+SDO \(ours\)\s+read 0x2021:02 output_frequency/);
  await expectAccessible(page, 'with a trace');
  await page.locator('#trace-run').click();
  assert.equal(await page.locator('#trace-note').textContent(), 'Paused.');
  const shown = await rows.allInnerTexts();
  await demo.command('sdo', 'read', 'pump1', '0x2021:02');
  await new Promise((resolve) => setTimeout(resolve, 500));
  assert.deepEqual(await rows.allInnerTexts(), shown, 'they stay as they were');
});

test('the map is searched', async () => {
  await page.locator('#map-search').fill('pump1 frequency register');
  const rows = await page.locator('#map-rows tr').allInnerTexts();
  assert.equal(rows.length, 2);
  assert.match(rows[0], /pump1\s+output_frequency\s+Hz\s+5: register 2\s+0x2021:02/);
  assert.match(rows[1], /canopen\/demo-demo\/pump1\/frequency_command\/set/);
});

test('it is used by keyboard', async () => {
  const other = await openPage(browser, demo.url, wide);
  const first = other.page.locator('#drive-fan1');
  await until('drives are shown', () => first.locator('.badge').count());
  const focused = () => other.page.evaluate(() => document.activeElement.closest('li')?.id || document.activeElement.className);
  const keys = [];
  while (keys.length < 12 && keys.at(-1) !== 'drive-fan1') {
    await other.page.keyboard.press('Tab');
    keys.push(await focused());
  }
  assert.equal(keys[0], 'skip');
  assert.equal(keys.at(-1), 'drive-fan1', keys.join(' '));
  assert.equal(await other.page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle), 'solid', 'visible focus');
  await other.page.keyboard.press('Enter');
  await until('it opens', () => first.locator('.body').count());
  await other.page.context().close();
});

test('nothing leaves this machine, nothing is complained of, and it is small', () => {
  const strangers = notes.asked.filter((url) => !url.startsWith(demo.url));
  assert.deepEqual(strangers, []);
  assert.ok(notes.asked.length > 15);
  assert.deepEqual(notes.complaints, []);
  const own = [...notes.sizes].filter(([name]) => name !== '/page/dygraph.js');
  const bytes = own.reduce((sum, [, size]) => sum + size, 0);
  console.log(`the page has ${bytes} bytes in ${own.length} files`);
  assert.ok(bytes > 10000 && bytes <= MOST_BYTES, `${bytes} bytes`);
});

test('a gateway that stands still, and one that is gone, are told', async () => {
  demo.process.kill('SIGSTOP');
  await until('it is away', () => page.locator('body.away').count());
  assert.match(await page.locator('#away').textContent(), /^No connection to the gateway since /);
  assert.match(await announced(), /connection to the gateway is lost/);
  assert.match(await page.title(), /^away: /);
  await expectAccessible(page, 'away');
  demo.process.kill('SIGCONT');
  await until('it is back', async () => await page.locator('body.away').count() === 0);
  demo.process.kill('SIGKILL');
  await until('it is away again', () => page.locator('body.away').count());
  demo.launch();
  await until('another life of it is shown', async () => await page.locator('#link').textContent() === 'live', 30);
  await until('with its drives', async () => await badge('hoist1').catch(() => '') === 'stopped');
});

test('in the dark, and on a phone', async () => {
  demo.order('9 unplug on');
  demo.order('5 fault 5');
  for (const [name, options] of [['dark', { ...wide, colorScheme: 'dark' }], ['phone', phone]]) {
    const other = await openPage(browser, demo.url, options);
    await until('it is live', async () => await other.page.locator('#link').textContent() === 'live');
    await until('alarms are shown', async () => await alarms(other.page, 'pump1', 'emcy').count() === 1
      && await alarms(other.page, 'mixer1', 'heartbeat').count() === 1);
    if (name === 'phone') {
      await other.page.locator('#drive-fan1 summary').tap();
      await until('it opens', () => other.page.locator('#drive-fan1 .body').count());
      assert.ok(await other.page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing is wider');
      await shot(other.page, 'phone');
    }
    await new Promise((resolve) => setTimeout(resolve, 2500));  // charts, for the picture
    await shot(other.page, name);
    await expectAccessible(other.page, name);
    await other.page.context().close();
  }
});

test('without dygraphs there are values', async () => {
  const context = await browser.newContext(wide);
  const bare = await context.newPage();
  const complaints = [];
  bare.on('pageerror', (error) => complaints.push(error.stack));
  await bare.route('**/page/dygraph.js', (route) => route.fulfill({ status: 404 }));
  await bare.goto(demo.url);
  await bare.locator('#drive-fan1 summary').click();
  await until('values', async () => (await bare.locator('#drive-fan1 dl.values .value').allTextContents()).includes('0.00'));
  assert.equal(await bare.locator('.chart').count(), 0);
  assert.deepEqual(complaints, []);
  await context.close();
});
