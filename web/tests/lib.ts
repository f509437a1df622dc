// A browser and a page for the tests: the built page on a server of its own, or `g7 serve`.
import assert from 'node:assert/strict';
import { spawn, type ChildProcess } from 'node:child_process';
import { once } from 'node:events';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import { createRequire } from 'node:module';
import type { AddressInfo } from 'node:net';
import { tmpdir } from 'node:os';
import { extname, join, normalize, resolve } from 'node:path';
import { chromium, type Browser, type BrowserContext, type Locator, type Page } from 'playwright-core';

const HERE = new URL('..', import.meta.url).pathname;
/** The built page; another one can be named for experiments. */
const DIST = resolve(process.env.G7_DIST ?? join(HERE, 'dist'));
export const TYPES: Record<string, string> = {
  '.html': 'text/html; charset=utf-8',
  '.js': 'text/javascript',
  '.css': 'text/css',
  '.json': 'application/json',
  '.svg': 'image/svg+xml',
  '.wasm': 'application/wasm',
  '.ttf': 'font/ttf',
};

export interface Site {
  url: string;
  /** The names of the files that were asked for, in their order; of the playground only. */
  fetched?: string[];
  stop(): Promise<void>;
  /** Kills the server without a clean end. */
  crash?(): Promise<void>;
}

/** The static playground, with these files as its examples. */
export async function playground(examples: Record<string, string>): Promise<Site> {
  const fetched: string[] = [];
  const server = createServer((request, response) => {
    const path = normalize(new URL(request.url ?? '/', 'http://localhost').pathname);
    fetched.push(path.slice(1));
    if (path === '/examples.json') {
      response.writeHead(200, { 'content-type': 'application/json' }).end(JSON.stringify(examples));
      return;
    }
    readFile(join(DIST, path === '/' ? 'index.html' : path)).then(
      (bytes) => response.writeHead(200, { 'content-type': TYPES[extname(path === '/' ? '.html' : path)] ?? 'text/html' }).end(bytes),
      () => response.writeHead(404).end(),
    );
  });
  await new Promise<void>((done) => server.listen(0, '127.0.0.1', done));
  return {
    url: `http://127.0.0.1:${(server.address() as AddressInfo).port}/`,
    fetched,
    stop: async () => {
      server.closeAllConnections();
      await new Promise((done) => server.close(done));
    },
  };
}

/** Where the servers of a test file keep copies of unsaved work, instead of the user's place. */
export const STATE = mkdtempSync(join(tmpdir(), 'g7-state-'));
process.once('exit', () => rmSync(STATE, { recursive: true, force: true }));

/** The program under test; the variable `G7` names it. */
export const program = (): string => process.env.G7 ?? join(HERE, '../target/release/g7');

/** `g7 serve` for a folder. */
export async function serve(folder: string, ...more: string[]): Promise<Site> {
  const port = more.includes('--port') ? [] : ['--port', '0'];
  const child = spawn(program(), ['serve', folder, ...port, '--no-open', ...more], {
    stdio: ['ignore', 'pipe', 'inherit'],
    env: { ...process.env, XDG_STATE_HOME: STATE },
  });
  const url = await new Promise<string>((found, failed) => {
    let said = '';
    child.stdout.on('data', (chunk: Buffer) => {
      said += chunk.toString();
      const address = /http:\/\/\S+/.exec(said)?.[0];
      if (address) found(address);
    });
    child.once('error', failed);
    child.once('exit', (code) => failed(new Error(`g7 serve ended with ${code}: ${said}`)));
  });
  return { url, stop: async () => void (await ended(child, 'SIGTERM')), crash: async () => void (await ended(child, 'SIGKILL')) };
}

/** Ends a program; its exit code. One that does not end within 20 s is killed, and the test fails instead of waiting for ever. */
export async function ended(child: ChildProcess, how: NodeJS.Signals): Promise<number | null> {
  if (child.exitCode !== null || child.signalCode !== null) return child.exitCode;
  const exit = once(child, 'exit');
  child.kill(how);
  // A frozen program hears the signal only when it goes on.
  child.kill('SIGCONT');
  const late = setTimeout(() => child.kill('SIGKILL'), 20_000);
  const [code, signal] = await exit;
  clearTimeout(late);
  if (signal === 'SIGKILL' && how !== 'SIGKILL') assert.fail(`${child.spawnargs.join(' ')} does not end by ${how}`);
  return code;
}

/** The warnings of the framework and the errors that no code caught, of all pages of this program. */
const heard: string[] = [];

// Told as the program ends, because a test that threw in a hook would leave its servers behind.
process.once('exit', () => {
  if (heard.length === 0) return;
  console.error(`pages warned ${heard.length} times:\n${[...new Set(heard)].join('\n')}`);
  process.exitCode = 1;
});

/** Hears every page of a browser. An address that does not answer is no warning: stories stop servers on purpose. */
function listen(to: Browser): void {
  const contexts = to.newContext.bind(to);
  to.newContext = async (options) => {
    const context = await contexts(options);
    // The empty page, on which scripts of a story run first, has no storage.
    context.on('weberror', (e) => e.error().message.includes('for this document') || heard.push(e.error().message));
    // Stories read canvases, which pages do not.
    const own = (text: string) => text.startsWith('Canvas2D: Multiple readback');
    context.on('console', (m) => (m.type() === 'warning' || m.text().includes('svelte.dev/e/')) && !own(m.text()) && heard.push(m.text()));
    return context;
  };
}

/** Debian's Chromium without access to the network. A warning on any of its pages makes the test file fail. */
export async function browser(): Promise<Browser & { done(): Promise<void> }> {
  const home = mkdtempSync(join(tmpdir(), 'g7-browser-'));
  const found = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'],
    env: { ...process.env, HOME: home },
  });
  listen(found);
  return Object.assign(found, {
    done: async () => {
      await found.close();
      rmSync(home, { recursive: true, force: true });
    },
  });
}

/** A page with the errors that it had. */
export type Opened = Page & { errors: string[] };

/** Opens a file in a new page; errors in the page make the test fail. */
export async function open(
  b: Browser,
  site: Site,
  file?: string,
  size = { width: 1280, height: 720 },
  before?: (context: BrowserContext) => Promise<unknown>,
): Promise<Opened> {
  const context = await b.newContext({ viewport: size, locale: 'en-GB', ignoreHTTPSErrors: true });
  await before?.(context);
  const page = await context.newPage();
  const errors: string[] = [];
  page.on('pageerror', (e) => errors.push(e.message));
  page.on('console', (m) => m.type() === 'error' && !m.text().includes('404') && errors.push(m.text()));
  const url = new URL(site.url);
  if (file) url.searchParams.set('file', file);
  await page.goto(url.href);
  if (file) await page.waitForSelector('.sheet [data-id]', { state: 'attached' });
  return Object.assign(page, { errors });
}

/** Opens a file with these settings of the user. Those that the page keeps later stay when it is loaded again. */
export function openWith(b: Browser, site: Site, file: string, prefs: object, size?: { width: number; height: number }): Promise<Opened> {
  const kept = JSON.stringify({ language: 'en', ...prefs });
  return open(b, site, file, size, (context) => context.addInitScript((text) => localStorage.getItem('g7-prefs') ?? localStorage.setItem('g7-prefs', text), kept));
}

/** Ends a page that had no errors. */
export async function done(page: Opened): Promise<void> {
  assert.deepEqual(page.errors, []);
  await page.context().close();
}

/** Chooses the language of the operator page by the label of its list: the headers of dialogs have lists too. */
export async function speak(page: Page, language: string): Promise<void> {
  await page.getByRole('combobox', { name: /^(Language|Langue|Língua)$/ }).selectOption({ label: language });
}

/** Charts without influence on one another, each with 5 steps and an input of its own, from `a0` on. Together they have 5^count states. */
export const cells = (count: number): string =>
  Array.from({ length: count }, (_, i) => `chart C${i} {\n  initial step 0\n${[1, 2, 3, 4].map((n) => `  step ${n}\n`).join('')}${[0, 1, 2, 3, 4].map((n) => `  ${n} -> ${(n + 1) % 5} when ↑a${i}\n`).join('')}}\n`).join('');

/** The names `a0`, `a1` and so on, for a declaration of inputs. */
export const inputs = (count: number): string => Array.from({ length: count }, (_, i) => `a${i}`).join(', ');

/** The text of the visible file, obtained by a download. */
export async function textOf(page: Page): Promise<string> {
  const [download] = await Promise.all([page.waitForEvent('download'), page.keyboard.press('Control+s')]);
  const parts: Buffer[] = [];
  for await (const part of await download.createReadStream()) parts.push(part as Buffer);
  return Buffer.concat(parts).toString('utf8');
}

/** Waits until every gesture is drawn, so that symbols stay where they are. */
export async function drawn(page: Page): Promise<void> {
  await page.locator('.sheet[aria-busy="false"]').waitFor({ state: 'attached' });
}

/** Waits until a condition holds; `said` names it in the failure. */
export async function until(what: () => Promise<boolean>, said: string, ms = 20_000): Promise<void> {
  const end = Date.now() + ms;
  while (!(await what())) {
    if (Date.now() > end) assert.fail(said);
    await new Promise((done) => setTimeout(done, 40));
  }
}

const AXE = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

/** The findings of the accessibility checker axe, after all fading has ended. */
export async function axe(page: Page): Promise<string[]> {
  await page.waitForFunction(() => document.getAnimations().every((a) => a.playState !== 'running' || a.effect?.getTiming().iterations === Infinity));
  await page.evaluate(AXE);
  return page.evaluate(async () => {
    const found = await (window as unknown as { axe: { run(): Promise<{ violations: { id: string; nodes: { html: string; failureSummary?: string }[] }[] }> } }).axe.run();
    return found.violations.flatMap((v) => v.nodes.map((n) => `${v.id}: ${n.html.slice(0, 160)} ${n.failureSummary?.split('\n')[1] ?? ''}`));
  });
}

export type Box = { x: number; y: number; width: number; height: number };

/** A symbol of the drawing. */
export const item = (page: Page, id: string) => page.locator(`.sheet [data-id="${id}"]`).first();

export async function box(of: Locator): Promise<Box> {
  const found = await of.boundingBox();
  if (!found) throw new Error(`${of} is not to be seen`);
  return found;
}

/** A place where a symbol can be pressed: in its square, bar or rectangle. */
export async function core(page: Page, id: string): Promise<[x: number, y: number]> {
  await drawn(page);
  const at = await box(item(page, id).locator('.g7-box, .g7-bar, .g7-action').first());
  return [at.x + Math.min(8, at.width / 2), at.y + Math.min(8, at.height / 2)];
}

/** Selects a symbol with the mouse. */
export async function press(page: Page, id: string): Promise<void> {
  await page.mouse.click(...(await core(page, id)));
  await page.locator('.marks .selected').first().waitFor({ state: 'attached' });
}
