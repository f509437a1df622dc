// Stories of the text beside the drawing: both views always agree, and problems are found and fixed
// in place.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { browser, open, playground, textOf, type Site } from './lib';

const LOOP = `// A loop.
input a : BOOL
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

before(async () => {
  site = await playground({ 'loop.g7': LOOP, 'wrong.g7': LOOP.replace('when a', 'when missing'), 'crlf.g7': LOOP.replaceAll('\n', '\r\n') });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

async function beside(file: string): Promise<Page & { errors: string[] }> {
  const page = await open(b, site, file);
  await page.getByRole('button', { name: 'Drawing and text' }).click();
  await page.waitForSelector('.tok-keyword');
  return page;
}

const text = async (page: Page) => (await page.locator('.cm-line').allInnerTexts()).map((line) => line.replace(/\n$/, '')).join('\n');

async function found<T>(ask: () => Promise<T>, good: (found: T) => boolean, what: string): Promise<T> {
  let now = await ask();
  for (let n = 0; n < 80 && !good(now); n++) {
    await new Promise((done) => setTimeout(done, 100));
    now = await ask();
  }
  assert.ok(good(now), `${what}: ${JSON.stringify(now)}`);
  return now;
}

/** Puts the cursor after a piece of text. */
async function behind(page: Page, piece: string): Promise<void> {
  await page.locator('.cm-content').click();
  await page.keyboard.press('Control+f');
  await page.keyboard.press('Control+a');
  await page.keyboard.type(piece);
  await page.keyboard.press('Enter');
  await page.keyboard.press('Escape');
  await page.keyboard.press('ArrowRight');
}

const drawn = (page: Page, id: string) => page.locator(`.sheet [data-id="${id}"]`).count();

test('what is typed is drawn, with signs that keyboards lack', async () => {
  const page = await beside('loop.g7');
  await behind(page, 'step 1 { N M }');
  await page.keyboard.press('Enter');
  await page.keyboard.type('step 2');
  await page.keyboard.press('Escape');
  await page.keyboard.press('Enter');
  await page.keyboard.type('1 -> 2 when \\upa');
  await found(() => drawn(page, 'G1/s/2'), (n) => n === 1, 'step 2 is drawn');
  assert.match(await text(page), /\n {2}step 2\n {2}1 -> 2 when ↑a\n/);
  assert.equal(await textOf(page), LOOP.replace('step 1 { N M }', 'step 1 { N M }\n  step 2\n  1 -> 2 when ↑a'));
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('undo goes through typing and gestures alike, from either view, to the first byte', async () => {
  const page = await beside('loop.g7');
  await behind(page, 'when a');
  await page.keyboard.type(' · not M');
  await found(() => page.locator('.sheet').innerHTML(), (html) => html.includes('·'), 'the receptivity is drawn');
  await page.keyboard.press('Escape');
  const step = await page.locator('.sheet [data-id="G1/s/1"]').boundingBox();
  assert.ok(step);
  await page.mouse.click(step.x + 8, step.y + 8);
  await page.keyboard.press('Tab');
  await found(() => text(page), (t) => t.includes('step 2'), 'the gesture is in the text');
  await page.keyboard.press('Escape');
  await page.locator('.cm-content').click();
  const undo = page.getByRole('button', { name: 'Undo', exact: true });
  for (let n = 0; n < 20 && (await undo.isEnabled()); n++) {
    await page.keyboard.press('Control+z');
    await page.waitForTimeout(120);
  }
  assert.equal(await text(page), LOOP);
  assert.equal(await textOf(page), LOOP);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('a syntax error keeps the last good drawing and says so', async () => {
  const page = await beside('loop.g7');
  await behind(page, 'step 1 {');
  await page.keyboard.type(' ) (');
  await page.getByText('this is the last good drawing').waitFor();
  assert.equal(await drawn(page, 'G1/s/1'), 1);
  await page.waitForSelector('.cm-lintRange-error, .cm-lint-marker-error');
  for (let n = 0; n < 4; n++) await page.keyboard.press('Backspace');
  await page.getByText('this is the last good drawing').waitFor({ state: 'hidden' });
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('a problem is marked at its place, and its fix mends it as one edit', async () => {
  const page = await beside('wrong.g7');
  const mark = page.locator('.cm-lintRange-error');
  await mark.waitFor();
  assert.equal(await mark.innerText(), 'missing');
  await mark.hover();
  await page.getByRole('button', { name: 'Explain' }).click();
  await page.locator('.g7-hover', { hasText: 'name' }).waitFor();
  await page.keyboard.press('Escape');
  await page.mouse.move(5, 300);
  await mark.hover();
  await page.getByRole('button', { name: /as an input/ }).first().click();
  await mark.waitFor({ state: 'detached' });
  assert.match(await text(page), /input missing : BOOL/);
  await page.locator('.cm-content').click();
  await page.keyboard.press('Control+z');
  await found(() => text(page), (t) => !t.includes('input missing'), 'one undo takes it back');
  await page.context().close();
});

test('the cursor and the selection in the drawing go together', async () => {
  const page = await beside('loop.g7');
  await behind(page, 'step 1');
  await page.getByRole('heading', { name: 'Step 1' }).waitFor();
  const step = await page.locator('.sheet [data-id="G1/s/0"]').boundingBox();
  assert.ok(step);
  await page.mouse.click(step.x + 8, step.y + 8);
  await found(() => page.locator('.cm-picked').allInnerTexts(), (lines) => lines.join() === '  initial step 0', 'the line of the step is marked');
  await page.context().close();
});

test('rename, declaration and uses by keys', async () => {
  const page = await beside('loop.g7');
  await behind(page, 'when not a');
  await page.keyboard.press('F2');
  await page.locator('.g7-small input').waitFor();
  await page.waitForTimeout(100);
  await page.keyboard.type('key');
  await page.keyboard.press('Enter');
  await found(() => text(page), (t) => t === LOOP.replace('input a', 'input key').replace('when a', 'when key').replace('not a', 'not key'), 'renamed everywhere');
  await page.keyboard.press('F12');
  await page.getByText('Line 2, column').waitFor();
  await page.keyboard.press('Shift+F12');
  await page.locator('.g7-places button:focus').waitFor();
  assert.equal(await page.locator('.g7-places button').count(), 3);
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('Enter');
  await page.getByText('Line 7, column').waitFor();
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('completion knows the names, format puts the text in order', async () => {
  const page = await beside('loop.g7');
  await behind(page, 'step 1 {');
  await page.keyboard.type('   N M');
  await page.locator('.cm-tooltip-autocomplete').waitFor();
  await page.keyboard.press('Escape');
  await page.keyboard.press('Shift+Alt+F');
  await found(() => text(page), (t) => !t.includes('{   N'), 'formatted');
  await page.context().close();
});

test('line ends of other systems stay where they are', async () => {
  const page = await beside('crlf.g7');
  await behind(page, 'when a');
  await page.keyboard.type(' and M');
  await found(() => page.locator('.sheet').innerHTML(), (html) => html.includes('M'), 'drawn');
  assert.equal(await textOf(page), LOOP.replace('when a', 'when a and M').replaceAll('\n', '\r\n'));
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('typing goes on while gestures are under way, and all of it is undone to the first byte', async () => {
  const page = await beside('loop.g7');
  const step = await page.locator('.sheet [data-id="G1/s/1"]').boundingBox();
  assert.ok(step);
  for (let round = 0; round < 4; round++) {
    await behind(page, 'when a');
    await page.keyboard.type(' and M and a and M');
    await page.keyboard.press('Escape');
    await page.mouse.click(step.x + 8, step.y + 8);
    await page.keyboard.press('i');
    await page.locator('.cm-content').click({ position: { x: 200, y: 5 } });
    await page.keyboard.press('Control+End');
    await page.keyboard.type('// note\n', { delay: 0 });
  }
  await page.waitForTimeout(800);
  const typed = await text(page);
  assert.equal(await textOf(page), typed);
  assert.equal(typed.match(/note/g)?.length, 4, typed);
  const undo = page.getByRole('button', { name: 'Undo', exact: true });
  for (let n = 0; n < 80 && (await undo.isEnabled()); n++) {
    await undo.click();
    await page.waitForTimeout(60);
  }
  assert.equal(await text(page), LOOP);
  assert.equal(await textOf(page), LOOP);
  const redo = page.getByRole('button', { name: 'Redo', exact: true });
  for (let n = 0; n < 80 && (await redo.isEnabled()); n++) {
    await redo.click();
    await page.waitForTimeout(60);
  }
  assert.equal(await text(page), typed);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});
