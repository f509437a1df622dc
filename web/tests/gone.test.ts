// Stories of a server that ends and is started again on its folder: work goes on meanwhile, and then goes on by itself.
import assert from 'node:assert/strict';
import { execFileSync, spawn, type ChildProcess } from 'node:child_process';
import { mkdtempSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, afterEach, before, beforeEach, test } from 'node:test';
import type { Page } from 'playwright-core';
import { axe, browser, ended, open, openWith, program, serve, STATE, until, type Opened, type Site } from './lib';

const TEXT = `input a : BOOL
output M : BOOL
chart G1 {
  initial step 0
  step 1 { N M }
  0 -> 1 when a
  1 -> 0 when not a
}
`;

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;
let folder: string;
/** Servers that a story has begun itself. */
let more: ChildProcess[] = [];

before(async () => {
  b = await browser();
});

after(async () => {
  await b?.done();
});

beforeEach(async () => {
  folder = mkdtempSync(join(tmpdir(), 'g7-gone-'));
  writeFileSync(join(folder, 'loop.g7'), TEXT);
  site = await serve(folder);
});

afterEach(async () => {
  await Promise.all([site.stop(), ...more.map((child) => ended(child, 'SIGTERM'))]);
  more = [];
  rmSync(folder, { recursive: true, force: true });
});

const port = () => new URL(site.url).port;
const disk = (name = 'loop.g7') => readFileSync(join(folder, name), 'utf8');
const banner = (page: Page) => page.getByRole('status').getByText('Your work is kept in this browser');
const notice = (page: Page, text: string) => page.locator('.notice').getByText(text).first();
const dirty = (page: Page) => page.locator('[role=tab] .dot');

/** The page with its text view. */
const opened = (): Promise<Opened> => openWith(b, site, 'loop.g7', { view: 'both' });

/** Types at the begin of the text. */
async function type(page: Page, text: string): Promise<void> {
  await page.locator('.cm-content').click();
  await page.keyboard.press('Control+Home');
  await page.keyboard.type(text);
}

/** The server ends without a farewell, and the page has noticed it. */
async function kill(...pages: Page[]): Promise<void> {
  // The token is noted within a moment of its first use.
  await until(() => Promise.resolve(tokens().length > 0), 'no token is kept');
  await site.crash?.();
  await Promise.all(pages.map((page) => banner(page).waitFor()));
}

/** The server is started again at the same address. */
async function restart(...more: string[]): Promise<void> {
  site = await serve(folder, '--port', port(), ...more);
}

/** A server with arguments of its own, and its address. */
async function begun(cwd: string, ...args: string[]): Promise<{ child: ChildProcess; url: string }> {
  const child = spawn(program(), ['serve', ...args, '--no-open'], { cwd, stdio: ['ignore', 'pipe', 'ignore'], env: { ...process.env, XDG_STATE_HOME: STATE } });
  more.push(child);
  return { child, url: (await new Promise<string>((found) => child.stdout.once('data', (chunk: Buffer) => found(String(chunk))))).trim() };
}

/** The files of the tokens of this folder. */
function tokens(): string[] {
  const all = (at: string): string[] => readdirSync(at).flatMap((name) => (statSync(join(at, name)).isDirectory() ? all(join(at, name)) : [join(at, name)]));
  return all(STATE).filter((at) => at.endsWith('.json') && at.includes('/pages/') && readFileSync(at, 'utf8').includes(`"${folder}"`));
}

/** Errors other than those of connections that nobody answers. */
const errors = (page: Opened) => page.errors.filter((text) => !/ERR_CONNECTION|WebSocket connection|status of 412/.test(text));

test('what is typed and saved while the server is gone is on the disk with no click, once it is back', async () => {
  const page = await opened();
  await type(page, '// one\n');
  await kill(page);
  await type(page, '// two\n');
  await page.keyboard.press('Control+s');
  await notice(page, 'loop.g7 will be saved when it is back').waitFor();
  await page.getByText('To be saved then: loop.g7.').waitFor();
  assert.deepEqual(await axe(page), []);
  // It is no part of what was saved.
  await type(page, '// three\n');
  assert.equal(disk(), TEXT);
  await restart();
  await until(() => Promise.resolve(disk() === `// two\n// one\n${TEXT}`), 'it is not saved');
  await banner(page).waitFor({ state: 'detached' });
  await notice(page, 'loop.g7 is saved.').waitFor();
  await dirty(page).waitFor();
  await page.keyboard.press('Control+s');
  await until(() => Promise.resolve(disk() === `// three\n// two\n// one\n${TEXT}`), 'the rest is not saved');
  await dirty(page).waitFor({ state: 'detached' });
  // The server watches the folder for this page again.
  writeFileSync(join(folder, 'loop.g7'), `// theirs\n${TEXT}`);
  await page.locator('.cm-content').getByText('// theirs').waitFor();
  assert.deepEqual(errors(page), []);
  await page.context().close();
});

test('a file that was changed meanwhile is not written over: the user is asked', async () => {
  const page = await opened();
  await type(page, '// mine\n');
  await kill(page);
  await page.keyboard.press('Control+s');
  await notice(page, 'loop.g7 will be saved').waitFor();
  const theirs = `// theirs\n${TEXT}`;
  writeFileSync(join(folder, 'loop.g7'), theirs);
  await restart();
  const asked = page.getByRole('alert').filter({ hasText: 'changed outside' });
  await asked.waitFor();
  await page.waitForTimeout(1500);
  assert.equal(disk(), theirs);
  await page.locator('.cm-content').getByText('// mine').waitFor();
  await asked.getByRole('button', { name: 'Keep mine' }).click();
  await page.keyboard.press('Control+s');
  await until(() => Promise.resolve(disk() === `// mine\n${TEXT}`), 'it is not saved');
  // The page has its answer: a save that is not answered is kept to be saved again.
  await dirty(page).waitFor({ state: 'detached' });
  // Without a change here, the text of the disk comes in by itself.
  await kill(page);
  writeFileSync(join(folder, 'loop.g7'), theirs);
  await restart();
  await page.locator('.cm-content').getByText('// theirs').waitFor();
  assert.equal(await dirty(page).count(), 0);
  assert.deepEqual(errors(page), []);
  await page.context().close();
});

test('a page that is loaded again has its work, and what was to be saved is saved', async () => {
  const page = await opened();
  await kill(page);
  await type(page, '// kept\n');
  await page.keyboard.press('Control+s');
  await notice(page, 'loop.g7 will be saved').waitFor();
  await type(page, '// later\n');
  await page.waitForFunction(() => Object.values(localStorage).some((text) => text.includes('// later')));
  // Nobody answers: the browser shows a page of its own. While that comes up, it refuses to be loaded again.
  await page.reload().catch(() => undefined);
  await restart();
  await until(() => page.reload().then(() => true, () => false), 'the page is not loaded');
  await until(() => Promise.resolve(disk() === `// kept\n${TEXT}`), 'it is not saved');
  await page.locator('.cm-content').getByText('// later').waitFor();
  await dirty(page).waitFor();
  await page.context().close();
});

test('a save whose answer was lost is no conflict', async () => {
  const page = await opened();
  await page.route('**/api/file?*', async (route) => {
    if (route.request().method() !== 'PUT') return route.continue();
    await route.fetch();
    await route.abort();
  });
  await type(page, '// mine\n');
  await page.keyboard.press('Control+s');
  await until(() => Promise.resolve(disk() === `// mine\n${TEXT}`), 'it is not written');
  await notice(page, 'loop.g7 will be saved').waitFor();
  await page.unroute('**/api/file?*');
  await kill(page);
  await restart();
  await notice(page, 'loop.g7 is saved.').waitFor();
  await dirty(page).waitFor({ state: 'detached' });
  assert.equal(await page.getByRole('alert').filter({ hasText: 'changed outside' }).count(), 0);
  await page.context().close();
});

test('a part that is not loaded yet is asked of nobody, and comes by itself when the server is back', async () => {
  const page = await opened();
  await kill(page);
  await page.getByRole('button', { name: 'Export' }).click();
  await page.getByText('This part of the page comes from the server').first().waitFor();
  assert.equal(await page.getByRole('button', { name: 'Download', exact: true }).isEnabled(), false);
  await restart();
  await until(() => page.getByRole('button', { name: 'Download', exact: true }).isEnabled(), 'nothing is exported');
  await page.context().close();
});

test('a shared run ends with the server, and the page says so; the drawing goes on', async () => {
  const page = await opened();
  await page.getByRole('switch', { name: 'Shared run' }).click();
  await page.locator('.clock').waitFor();
  await page.getByRole('button', { name: 'Run', exact: true }).click();
  await page.getByRole('button', { name: 'Pause', exact: true }).waitFor();
  await kill(page);
  await page.getByTitle('this is what was heard last').waitFor();
  await page.getByRole('button', { name: 'Run', exact: true }).waitFor();
  await restart();
  await notice(page, 'The shared run of loop.g7 ended with the server.').waitFor();
  await page.locator('.clock').waitFor({ state: 'detached' });
  await page.getByRole('button', { name: 'One scan', exact: true }).click();
  await page.locator('.clock').waitFor();
  assert.equal(await page.getByRole('switch', { name: 'Shared run' }).getAttribute('aria-checked'), 'false');
  assert.deepEqual(errors(page), []);
  await page.context().close();
});

test('a page tells its token to no stranger at the same port', async () => {
  const page = await opened();
  await kill(page);
  const heard: string[] = [];
  const stranger = createServer((request, response) => {
    heard.push(`${request.url} ${JSON.stringify(request.headers)}`);
    response.writeHead(200, { 'content-type': 'application/json' }).end('{"proofs":["00"],"place":"x"}');
  });
  await new Promise<void>((done) => stranger.listen(Number(port()), '127.0.0.1', done));
  await page.getByText('does not know this page').waitFor();
  await type(page, '// mine\n');
  await page.keyboard.press('Control+s');
  await notice(page, 'loop.g7 will be saved').waitFor();
  await until(() => Promise.resolve(heard.length > 3), 'nobody asks');
  const token = new URL(site.url).searchParams.get('token') ?? '';
  assert.equal(token.length, 48);
  assert.ok(heard.every((text) => !text.includes(token) && (text.startsWith('/api/again') || !text.startsWith('/api'))), heard.join('\n'));
  stranger.closeAllConnections();
  await new Promise((done) => stranger.close(done));
  await restart();
  await until(() => Promise.resolve(disk() === `// mine\n${TEXT}`), 'it is not saved');
  await page.context().close();
});

test('another folder, and a start that forgets, do not know the page', async () => {
  const page = await opened();
  await kill(page);
  const other = mkdtempSync(join(tmpdir(), 'g7-other-'));
  writeFileSync(join(other, 'loop.g7'), TEXT);
  await type(page, '// mine\n');
  await page.keyboard.press('Control+s');
  const wrong = await serve(other, '--port', port());
  await page.getByText('does not know this page').waitFor();
  await page.waitForTimeout(2000);
  assert.equal(readFileSync(join(other, 'loop.g7'), 'utf8'), TEXT);
  await wrong.stop();
  await banner(page).waitFor();
  await restart('--forget');
  await page.getByText('does not know this page').waitFor();
  await page.waitForTimeout(2000);
  assert.equal(disk(), TEXT);
  // The address that it printed lets the same tab in, with its work and its wish.
  await page.goto(site.url);
  await until(() => Promise.resolve(disk() === `// mine\n${TEXT}`), 'it is not saved');
  await page.context().close();
  rmSync(other, { recursive: true, force: true });
});

test('a restart without a port comes back to the one where the page waits', async () => {
  const page = await opened();
  await kill(page);
  assert.equal(new URL((await begun(folder, folder)).url).port, port());
  await banner(page).waitFor({ state: 'detached' });
  await page.context().close();
});

test('a browser that keeps nothing says so, and offers the text', async () => {
  const page = await opened();
  await page.evaluate(() => {
    Storage.prototype.setItem = () => {
      throw new DOMException('full', 'QuotaExceededError');
    };
  });
  await type(page, '// mine\n');
  await site.crash?.();
  await page.getByText('this browser keeps no copy').waitFor();
  const [download] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: 'Download: loop.g7' }).click()]);
  assert.match(readFileSync(await download.path(), 'utf8'), /^\/\/ mine/);
  await page.context().close();
});

test('users stay logged in over a restart', async () => {
  const guarded = mkdtempSync(join(tmpdir(), 'g7-guarded-'));
  writeFileSync(join(guarded, 'loop.g7'), TEXT);
  const run = (...args: string[]) => execFileSync(program(), args, { cwd: guarded, stdio: ['pipe', 'ignore', 'ignore'], input: 'correct horse\n' });
  run('cert');
  run('users', 'add', 'g7.users', 'ana', 'admin');
  const begin = (at: string) => begun(guarded, '.', '--port', at, '--users', 'g7.users', '--cert', 'g7.cert.pem', '--key', 'g7.key.pem');
  const { child, url } = await begin('0');
  const page = await open(b, { url: `${url}?file=loop.g7`, stop: async () => undefined });
  await page.getByLabel('Name', { exact: true }).fill('ana');
  await page.getByLabel('Password', { exact: true }).fill('correct horse');
  await page.getByRole('button', { name: 'Log in', exact: true }).click();
  await page.locator('[data-id="G1/s/1"]').waitFor({ state: 'attached' });
  await ended(child, 'SIGKILL');
  await banner(page).waitFor();
  await page.locator('.sheet').focus();
  for (let n = 0; n < 3; n++) await page.keyboard.press('ArrowDown');
  await page.keyboard.press('F2');
  await page.locator('.inplace > input').fill('Mine');
  await page.keyboard.press('Enter');
  await page.locator('[data-id="G1/s/Mine"]').waitFor({ state: 'attached' });
  await page.keyboard.press('Control+s');
  await begin(new URL(url).port);
  await until(() => Promise.resolve(readFileSync(join(guarded, 'loop.g7'), 'utf8').includes('step Mine')), 'it is not saved');
  await banner(page).waitFor({ state: 'detached' });
  assert.equal(await page.getByRole('heading', { name: 'Log in' }).count(), 0);
  await page.context().close();
  rmSync(guarded, { recursive: true, force: true });
});
