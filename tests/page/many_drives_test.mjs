// The page of a plant with 127 drives, all of which change: the browser is never kept from its reader for long.
// PAGE_SECONDS: for how long it is looked at.
import assert from 'node:assert/strict';
import net from 'node:net';
import { test } from 'node:test';
import { Demo, openBrowser, openPage, until } from './support.mjs';

const DRIVES = 127;
const LONGEST_TASK = 100;  // ms by the clock, on a quiet machine; of the processor is told beside it
const seconds = Number(process.env.PAGE_SECONDS ?? 10);

// Two buses, since the gateway takes a node id of each; the simulator wants each node id once.
function site(port) {
  const lines = ['[gateway]', 'name = "many"', '[http]', `listen = "127.0.0.1:${port}"`];
  for (const bus of ['east', 'west']) {
    lines.push('[[bus]]', `name = "${bus}"`, 'interface = "virtual"', 'bitrate = 1000000', `node_id = ${bus === 'east' ? 127 : 1}`);
  }
  for (let i = 0; i < DRIVES; ++i) {
    lines.push('[[drive]]', `name = "drive${i + 1}"`, `bus = "${i < 64 ? 'east' : 'west'}"`, `node = ${i + 1}`,
      'profile = "veichi-ac310"', 'presets = ["veichi-command-codes"]', '[drive.commands]', 'writers = ["local"]');
  }
  return lines.join('\n');
}

// A new frequency for each drive, again and again, so that all values move.
async function driveThemAll(demo) {
  const path = await until('the control socket is named', () => /(\/\S+\/control)\b/.exec(demo.output)?.[1]);
  const socket = net.connect(path);
  let drive = 0;
  let answers = 0;
  socket.on('data', (text) => { answers += String(text).split('"ok":true').length - 1; });
  const timer = setInterval(() => {
    for (let k = 0; k < 10; ++k) {
      drive = drive % DRIVES + 1;
      const values = { frequency_command: 10 + Math.floor(Date.now() / 70) % 40, torque_command: 0, control_command: 'forward' };
      socket.write(`${JSON.stringify({ op: 'set', drive: `drive${drive}`, values })}\n`);
    }
  }, 200);
  return { stop: () => { clearInterval(timer); socket.destroy(); }, answers: () => answers };
}

// A task that is too long, to see that it is noted: some half a second.
function tarry() {
  let sum = 0;
  for (let i = 0; i < 5e8; ++i) {
    sum += i % 7;
  }
  return sum;
}

/** The tasks of the page's thread since the trace began, in ms: of the processor (where that was taken; else, with tasks of
    a microsecond, by the clock), and by the clock; the longest first. */
async function tasksOf(browser) {
  const { traceEvents } = JSON.parse(await browser.stopTracing());
  const threads = new Set(traceEvents.filter((event) => event.name === 'thread_name' && event.args.name === 'CrRendererMain')
    .map((event) => `${event.pid}/${event.tid}`));
  return traceEvents.filter((event) => event.ph === 'X' && event.name === 'ThreadControllerImpl::RunTask'
    && threads.has(`${event.pid}/${event.tid}`))
    .map((event) => ({ processor: (event.tdur ?? event.dur) / 1000, clock: event.dur / 1000 }))
    .sort((one, other) => other.processor - one.processor);
}

const trace = (browser, page) => browser.startTracing(page, { categories: ['toplevel'] });

test(`no task of the page takes ${LONGEST_TASK} ms, ${seconds} s long`, async () => {
  const demo = await Demo.start(site);
  const browser = await openBrowser();
  try {
    await until('all drives are online', async () => (await demo.get('health')).drives_online === DRIVES, 60);
    const { page, notes } = await openPage(browser, 'about:blank', { viewport: { width: 1280, height: 900 } });
    await trace(browser, page);
    const moving = await driveThemAll(demo);
    await page.goto(demo.url);
    await until('all drives are shown', async () => await page.locator('#drive-list > li .badge').count() === DRIVES);
    await page.evaluate(() => {
      globalThis.changes = 0;
      new MutationObserver((list) => { globalThis.changes += list.length; })
        .observe(document.getElementById('drive-list'), { subtree: true, childList: true, characterData: true });
    });
    await page.locator('#drive-drive5 summary').click();
    const end = Date.now() + seconds * 1000;
    while (Date.now() < end) {
      await page.mouse.wheel(0, Date.now() % 2 ? 400 : -300);
      await new Promise((resolve) => setTimeout(resolve, 500));
    }
    await page.locator('#drive-filter').fill('drive12');
    await until('the filter shows some', async () => await page.locator('#drive-list > li:not([hidden])').count() === 9);
    moving.stop();
    const changes = await page.evaluate(() => globalThis.changes);
    const tasks = await tasksOf(browser);
    console.log(`${changes} changes, ${tasks.length} tasks, the longest ${tasks[0].processor} ms of the processor, `
      + `${Math.max(...tasks.map((task) => task.clock))} ms by the clock`);
    assert.ok(moving.answers() > 20, 'drives were commanded');
    assert.ok(changes > 20 * seconds, `${changes} changes`);
    assert.ok(tasks.length > 10 * seconds, `${tasks.length} tasks`);
    assert.deepEqual(tasks.filter((task) => task.clock > LONGEST_TASK), []);
    assert.deepEqual(notes.complaints, []);
    await trace(browser, page);
    await page.evaluate(tarry);
    assert.ok((await tasksOf(browser))[0].processor > LONGEST_TASK, 'long tasks are noted');
  } finally {
    await browser.close();
    await demo.end();
  }
});
