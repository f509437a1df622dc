// Stories of files: saved completely, changed outside, recovered after a crash, opened by two
// pages.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, afterEach, before, beforeEach, test } from 'node:test';
import type { Page } from 'playwright-core';
import { browser, open, serve, type Site } from './lib';

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
const path = () => join(folder, 'loop.g7');
const onDisk = () => readFileSync(path(), 'utf8');

before(async () => {
  b = await browser();
});

after(async () => {
  await b?.done();
});

beforeEach(async () => {
  folder = mkdtempSync(join(tmpdir(), 'g7-files-'));
  writeFileSync(path(), TEXT);
  site = await serve(folder);
});

afterEach(async () => {
  await site.stop();
  rmSync(folder, { recursive: true, force: true });
});

/** Renames step 1 without saving. */
async function rename(page: Page, to: string): Promise<void> {
  await page.locator('.sheet').focus();
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('F2');
  await page.locator('.inplace > input').fill(to);
  await page.keyboard.press('Enter');
  await page.locator(`[data-id="G1/s/${to}"]`).waitFor({ state: 'attached' });
}

const dirty = (page: Page) => page.locator('[role=tab] .dot');
const step = (page: Page, name: string) => page.locator(`[data-id="G1/s/${name}"]`);

test('a change is saved, and nothing else is changed', async () => {
  const page = await open(b, site, 'loop.g7');
  await rename(page, 'Fill');
  await dirty(page).waitFor();
  assert.equal(onDisk(), TEXT);
  await page.keyboard.press('Control+s');
  await dirty(page).waitFor({ state: 'detached' });
  assert.equal(onDisk(), TEXT.replaceAll('step 1', 'step Fill').replace('-> 1', '-> Fill').replace('1 ->', 'Fill ->'));
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('a file changed outside is taken over where nothing was changed here', async () => {
  const page = await open(b, site, 'loop.g7');
  writeFileSync(path(), TEXT.replaceAll('step 1', 'step 7').replace('-> 1', '-> 7').replace('1 ->', '7 ->'));
  await step(page, '7').waitFor({ state: 'attached' });
  assert.equal(await dirty(page).count(), 0);
  await page.context().close();
});

test('a file changed on both sides is never written over unasked', async () => {
  const page = await open(b, site, 'loop.g7');
  await rename(page, 'Mine');
  const theirs = TEXT.replace('not a', 'a');
  writeFileSync(path(), theirs);
  const bar = page.getByRole('alert');
  await bar.waitFor();
  await page.keyboard.press('Control+s');
  await page.waitForTimeout(400);
  assert.equal(onDisk(), theirs);
  await bar.getByRole('button', { name: 'Keep mine' }).click();
  await page.locator('.sheet').focus();
  await page.keyboard.press('Control+s');
  await dirty(page).waitFor({ state: 'detached' });
  assert.match(onDisk(), /step Mine/);
  await page.context().close();
});

test('theirs can be taken, and that undone', async () => {
  const page = await open(b, site, 'loop.g7');
  await rename(page, 'Mine');
  writeFileSync(path(), TEXT.replace('step 1 {', 'step 1 "theirs" {'));
  await page.getByRole('button', { name: 'Take theirs' }).click();
  await step(page, '1').waitFor({ state: 'attached' });
  assert.equal(await dirty(page).count(), 0);
  await page.locator('.sheet').focus();
  await page.keyboard.press('Control+z');
  await step(page, 'Mine').waitFor({ state: 'attached' });
  await page.context().close();
});

test('both sides can be merged where they changed different lines, and the merging undone', async () => {
  const page = await open(b, site, 'loop.g7');
  await rename(page, 'Mine');
  const theirs = `// theirs\n${TEXT}`;
  writeFileSync(path(), theirs);
  const bar = page.getByRole('alert');
  await bar.getByRole('button', { name: 'Merge' }).click();
  await bar.waitFor({ state: 'detached' });
  await page.locator('.sheet').focus();
  await page.keyboard.press('Control+s');
  await dirty(page).waitFor({ state: 'detached' });
  assert.match(onDisk(), /^\/\/ theirs\n/);
  assert.match(onDisk(), /step Mine/);
  await page.keyboard.press('Control+z');
  await dirty(page).waitFor();
  await page.keyboard.press('Control+s');
  await dirty(page).waitFor({ state: 'detached' });
  assert.doesNotMatch(onDisk(), /theirs/);
  await page.context().close();
});

test('what both sides changed in one line is not merged: the question stays', async () => {
  const page = await open(b, site, 'loop.g7');
  await rename(page, 'Mine');
  const theirs = TEXT.replace('step 1', 'step Theirs').replace('-> 1', '-> Theirs').replace('1 ->', 'Theirs ->');
  writeFileSync(path(), theirs);
  const bar = page.getByRole('alert').filter({ hasText: 'changed outside' });
  await bar.getByRole('button', { name: 'Merge' }).click();
  await page.getByText('Both changed the same lines').waitFor();
  await bar.waitFor();
  assert.equal(onDisk(), theirs);
  await step(page, 'Mine').waitFor({ state: 'attached' });
  await page.context().close();
});

test('after a crash of page and server the work is there again', async () => {
  const page = await open(b, site, 'loop.g7');
  await rename(page, 'Kept');
  await page.waitForTimeout(2000);
  await page.context().close();
  await site.crash?.();
  assert.equal(onDisk(), TEXT);
  site = await serve(folder);
  const again = await open(b, site);
  await step(again, 'Kept').waitFor({ state: 'attached' });
  await dirty(again).waitFor();
  await again.locator('.sheet').focus();
  await again.keyboard.press('Control+s');
  await dirty(again).waitFor({ state: 'detached' });
  assert.match(onDisk(), /step Kept/);
  await again.context().close();
});

test('work that the server could not keep is kept by the browser', async () => {
  const page = await open(b, site, 'loop.g7');
  const { port } = new URL(site.url);
  await site.crash?.();
  await rename(page, 'Kept');
  await page.waitForFunction(() => Object.values(localStorage).some((text) => text.includes('step Kept')));
  site = await serve(folder, '--port', port);
  await page.goto(site.url);
  await step(page, 'Kept').waitFor({ state: 'attached' });
  await dirty(page).waitFor();
  await page.locator('.sheet').focus();
  await page.keyboard.press('Control+s');
  await dirty(page).waitFor({ state: 'detached' });
  assert.match(onDisk(), /step Kept/);
  await page.waitForFunction(() => !Object.keys(localStorage).some((key) => key.startsWith('g7-work')));
  await page.context().close();
});

test('two windows see the same file', async () => {
  const one = await open(b, site, 'loop.g7');
  const two = await open(b, site, 'loop.g7');
  await rename(one, 'Both');
  await one.keyboard.press('Control+s');
  await step(two, 'Both').waitFor({ state: 'attached' });
  await one.context().close();
  await two.context().close();
});

test('where nothing may be written, nothing is', async () => {
  await site.stop();
  site = await serve(folder, '--read-only');
  const page = await open(b, site, 'loop.g7');
  await rename(page, 'New');
  const [download] = await Promise.all([page.waitForEvent('download'), page.keyboard.press('Control+s')]);
  assert.equal(download.suggestedFilename(), 'loop.g7');
  assert.equal(onDisk(), TEXT);
  await page.context().close();
});
