// Stories of unsaved work: it belongs to a window, is never taken from one that is there, and can be had back.
import assert from 'node:assert/strict';
import { mkdtempSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, afterEach, before, beforeEach, test } from 'node:test';
import type { Page } from 'playwright-core';
import { axe, browser, done, open, openWith, playground, serve, STATE, until, type Site } from './lib';

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

before(async () => {
  b = await browser();
});

after(async () => {
  await b?.done();
});

beforeEach(async () => {
  folder = mkdtempSync(join(tmpdir(), 'g7-drafts-'));
  writeFileSync(join(folder, 'loop.g7'), TEXT);
  site = await serve(folder);
});

afterEach(async () => {
  await site.stop();
  rmSync(folder, { recursive: true, force: true });
});

/** Renames step 1 without saving; it is selected first. */
async function rename(page: Page, to: string, down = 3): Promise<void> {
  await page.locator('.sheet').focus();
  for (let n = 0; n < down; n++) await page.keyboard.press('ArrowDown');
  await page.keyboard.press('F2');
  await page.locator('.inplace > input').fill(to);
  await page.keyboard.press('Enter');
  await step(page, to).waitFor({ state: 'attached' });
}

const step = (page: Page, name: string) => page.locator(`[data-id="G1/s/${name}"]`);
const dirty = (page: Page) => page.locator('[role=tab] .dot');
const elsewhere = (page: Page) => page.getByText('is open in another window');
const close = (page: Page) => page.getByRole('button', { name: 'Close loop.g7' }).click();
const rows = (page: Page) => page.getByRole('dialog', { name: 'Unsaved work' }).locator('li');

/** The texts of the copies on the disk that contain a word. */
function kept(word: string): string[] {
  const all = (at: string): string[] => readdirSync(at).flatMap((name) => (statSync(join(at, name)).isDirectory() ? all(join(at, name)) : [join(at, name)]));
  return all(STATE).filter((at) => at.endsWith('.json')).map((at) => readFileSync(at, 'utf8')).filter((text) => text.includes(word));
}

const isKept = (word: string) => until(() => Promise.resolve(kept(word).length > 0), `${word} is not kept`);

test('a second browser takes nothing from the first one, and deletes nothing', async () => {
  const one = await open(b, site, 'loop.g7');
  await rename(one, 'First');
  await isKept('step First');
  const two = await open(b, site, 'loop.g7');
  await elsewhere(two).waitFor();
  await step(two, '1').waitFor({ state: 'attached' });
  assert.equal(await dirty(two).count(), 0);
  await close(two);
  await step(two, '1').waitFor({ state: 'detached' });
  await two.waitForTimeout(1500);
  assert.equal(kept('step First').length, 1);
  await done(two);
  // The first one comes again with its own work, also in a third window that asks later.
  await one.reload();
  await step(one, 'First').waitFor({ state: 'attached' });
  await dirty(one).waitFor();
  await done(one);
  const three = await open(b, site, 'loop.g7');
  await step(three, 'First').waitFor({ state: 'attached' });
  await done(three);
});

test('a copy of a tab is another window', async () => {
  const one = await open(b, site, 'loop.g7');
  await rename(one, 'First');
  await isKept('step First');
  const [two] = await Promise.all([one.context().waitForEvent('page'), one.evaluate(() => void window.open(location.href))]);
  await elsewhere(two).waitFor();
  assert.equal(await dirty(two).count(), 0);
  await two.close();
  await done(one);
});

test('a window that is open hears that another one has begun, saved, or gone', async () => {
  const one = await open(b, site, 'loop.g7');
  const two = await open(b, site, 'loop.g7');
  await rename(one, 'First');
  await elsewhere(two).waitFor();
  await one.keyboard.press('Control+s');
  await elsewhere(two).waitFor({ state: 'detached' });
  await step(two, 'First').waitFor({ state: 'attached' });
  await rename(one, 'Second', 0);
  await elsewhere(two).waitFor();
  await isKept('step Second');
  await done(one);
  const bar = two.getByRole('status').filter({ hasText: 'left unsaved changes' });
  await bar.getByRole('button', { name: 'Restore' }).click();
  await step(two, 'Second').waitFor({ state: 'attached' });
  await dirty(two).waitFor();
  await bar.waitFor({ state: 'detached' });
  await done(two);
});

test('what was closed without saving can be had back, and is deleted after a question', async () => {
  const page = await open(b, site, 'loop.g7');
  await rename(page, 'Thrown');
  await close(page);
  await page.getByRole('button', { name: 'Close without saving' }).click();
  await step(page, 'Thrown').waitFor({ state: 'detached' });
  await page.reload();
  await step(page, '1').waitFor({ state: 'attached' });
  const list = page.getByRole('button', { name: 'Unsaved work' });
  await list.click();
  await rows(page).first().waitFor();
  assert.deepEqual(await axe(page), []);
  await rows(page).getByRole('button', { name: 'Restore' }).click();
  await step(page, 'Thrown').waitFor({ state: 'attached' });
  await dirty(page).waitFor();
  await list.click();
  await rows(page).getByRole('button', { name: 'Delete' }).click();
  assert.equal(kept('"closed":true').length, 1);
  await rows(page).getByRole('button', { name: 'Delete for good?' }).click();
  await until(() => Promise.resolve(kept('"closed":true').length === 0), 'it is still there');
  await done(page);
});

test('a file that was changed since is not written over by work that was recovered', async () => {
  const one = await open(b, site, 'loop.g7');
  await rename(one, 'Mine');
  await isKept('step Mine');
  await one.context().close();
  const theirs = `// theirs\n${TEXT}`;
  writeFileSync(join(folder, 'loop.g7'), theirs);
  const two = await open(b, site, 'loop.g7');
  await step(two, 'Mine').waitFor({ state: 'attached' });
  await two.getByRole('alert').filter({ hasText: 'changed outside' }).waitFor();
  await two.keyboard.press('Control+s');
  await two.waitForTimeout(400);
  assert.equal(readFileSync(join(folder, 'loop.g7'), 'utf8'), theirs);
  await two.context().close();
});

test('who types without a pause has a copy all the same', async () => {
  const page = await openWith(b, site, 'loop.g7', { view: 'both' });
  await page.locator('.cm-content').click();
  await page.keyboard.press('Control+Home');
  await page.keyboard.type('// without', { delay: 20 });
  for (let n = 0; n < 12 && kept('// without').length === 0; n++) await page.keyboard.type(' a pause', { delay: 60 });
  assert.equal(kept('// without').length, 1);
  await done(page);
});

test('in the playground two tabs have their own work', async () => {
  const play = await playground({ 'loop.g7': TEXT });
  const one = await open(b, play, 'loop.g7');
  await rename(one, 'First');
  await one.waitForFunction(() => Object.values(localStorage).some((text) => text.includes('step First')));
  const two = await one.context().newPage();
  await two.goto(one.url());
  await elsewhere(two).waitFor();
  assert.equal(await dirty(two).count(), 0);
  await two.close();
  await one.close();
  const three = await b.contexts().at(-1)?.newPage();
  assert.ok(three);
  await three.goto(`${play.url}?file=loop.g7`);
  await step(three, 'First').waitFor({ state: 'attached' });
  await dirty(three).waitFor();
  await three.context().close();
  await play.stop();
});
