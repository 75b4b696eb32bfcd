// What the tests of the page share: a demo of the gateway with drives that can be made to misbehave, and a browser.
import assert from 'node:assert/strict';
import { execFile, spawn } from 'node:child_process';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { promisify } from 'node:util';

export const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../..');
const program = process.env.GATEWAY_BIN ?? path.join(root, 'build/release/daemon/canopen-gateway');
const profiles = ['--profile-dir', path.join(root, 'config/profiles')];
const packages = createRequire(path.join(root, 'build/npm-page/package.json'));
const { chromium } = packages('playwright-core');
const axeSource = fs.readFileSync(packages.resolve('axe-core/axe.min.js'), 'utf8');

/** Until `look` gives something true; that is given back. */
export async function until(what, look, seconds = 15) {
  const end = Date.now() + seconds * 1000;
  for (;;) {
    const found = await look();
    if (found) {
      return found;
    }
    assert.ok(Date.now() < end, `not within ${seconds} s: ${what}`);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

async function freePort() {
  const server = net.createServer().listen(0, '127.0.0.1');
  await new Promise((resolve) => server.once('listening', resolve));
  const { port } = server.address();
  await new Promise((resolve) => server.close(resolve));
  return port;
}

/** The gateway and its drives in one process. `configure(port)`: the text of the configuration. */
export class Demo {
  static async start(configure) {
    const demo = new Demo();
    demo.folder = fs.mkdtempSync(path.join(os.tmpdir(), 'page-test.'));
    const port = await freePort();
    fs.writeFileSync(path.join(demo.folder, 'site.toml'), await configure(port, await freePort()));
    demo.url = `http://127.0.0.1:${port}/`;
    demo.launch();
    await until('the server answers', () => {
      assert.equal(demo.process.exitCode, null, `the demo has ended, see ${demo.folder}/demo.err`);
      return fetch(`${demo.url}health`, { signal: AbortSignal.timeout(5000) }).then(() => true, () => false);
    });
    return demo;
  }

  launch() {
    const log = fs.openSync(path.join(this.folder, 'demo.err'), 'a');
    this.output = '';
    this.process = spawn(program, [...profiles, '--config', path.join(this.folder, 'site.toml'), 'demo'],
      { stdio: ['pipe', 'pipe', log] });
    this.process.stdout.on('data', (text) => { this.output += text; });
  }

  /** As one types it into the demo's terminal. */
  order(text) {
    this.process.stdin.write(`${text}\n`);
  }

  /** What `canopen-gateway COMMAND` says, asked of this demo. */
  async command(...words) {
    const control = await until('the control socket is named', () => /(\/\S+\/control)\b/.exec(this.output)?.[1]);
    return (await promisify(execFile)(program, [...words, '--control', control])).stdout;
  }

  async get(target) {
    return (await fetch(this.url + target, { signal: AbortSignal.timeout(5000) })).json();
  }

  async end() {
    const ended = new Promise((resolve) => this.process.once('exit', resolve));
    this.process.kill('SIGCONT');
    this.process.kill('SIGTERM');
    await ended;
    fs.rmSync(this.folder, { recursive: true });
  }
}

/** A browser that reaches this machine alone. */
export function openBrowser() {
  return chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--disable-gpu', '--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1'] });
}

/** The page in a window; what it asks for and complains of is noted. */
export async function openPage(browser, url, options = {}) {
  const context = await browser.newContext(options);
  const page = await context.newPage();
  const notes = { asked: [], sizes: new Map(), complaints: [] };
  page.on('request', (request) => notes.asked.push(request.url()));
  page.on('console', (message) => ['error', 'warning'].includes(message.type()) && notes.complaints.push(message.text()));
  page.on('pageerror', (error) => notes.complaints.push(error.stack));
  page.on('response', (answer) => {
    const { pathname } = new URL(answer.url());
    if (pathname === '/' || pathname.startsWith('/page/')) {
      notes.sizes.set(pathname, Number(answer.headers()['content-length']));
    }
  });
  await page.goto(url);
  return { page, notes };
}

/** Nothing of axe-core's rules is broken. */
export async function expectAccessible(page, when) {
  await page.evaluate(`${axeSource};0`);
  const found = await page.evaluate(() => globalThis.axe.run());
  assert.ok(found.passes.length > 20, `${when}: axe looked at too little`);
  const words = found.violations.flatMap((rule) => rule.nodes.map((node) => `${rule.id}: ${node.html}: ${node.failureSummary}`));
  assert.deepEqual(words, [], when);
}

/** The site of the demo, at other ports. */
export function demoSite(httpPort, modbusPort) {
  return fs.readFileSync(path.join(root, 'config/demo.toml'), 'utf8')
    .replace(/^listen = "127.0.0.1:\d+"/m, `listen = "127.0.0.1:${httpPort}"`)
    .replace(/127.0.0.1:1502/g, `127.0.0.1:${modbusPort}`)
    .replace('127.0.0.1:1883', '127.0.0.1:9');  // no broker is there
}
