// Stories of comments on the drawing and of the panel of properties.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { axe, browser, item, open, playground, press, textOf, type Site } from './lib';

const LOOP = `input a, b : BOOL
chart G1 {
  initial step 0
  step 1
  step 2
  0 -> 1 when a
  1 -> 2 when b
  2 -> 0 when a
}
`;

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'loop.g7': LOOP });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

/** Waits until the text matches. */
async function says(page: Page, wanted: RegExp): Promise<void> {
  let text = '';
  for (let n = 0; n < 20 && !wanted.test(text); n++) text = await textOf(page);
  assert.match(text, wanted);
}

test('a comment is put on the drawing, moved, changed and taken away', async () => {
  const page = await open(b, site, 'loop.g7');
  await page.locator('.sheet').focus();
  await page.keyboard.press('c');
  await page.locator('.inplace > input').fill('what it does');
  await page.keyboard.press('Enter');
  const note = item(page, 'G1/n/0');
  await note.waitFor({ state: 'attached' });
  await says(page, /layout G1 \{\s+comment "what it does" at \(/);
  const box = await note.boundingBox();
  assert.ok(box);
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 120, y + 10, { steps: 4 });
  await page.mouse.up();
  await page.waitForFunction(
    (was) => (document.querySelector('.sheet [data-id="G1/n/0"]')?.getBoundingClientRect().x ?? was) > was + 60,
    box.x,
  );
  await page.locator('.sheet').focus();
  await page.keyboard.press('Enter');
  await page.locator('.inplace > input').fill('why');
  await page.keyboard.press('Enter');
  await says(page, /comment "why" at \(/);
  await page.locator('.sheet').focus();
  await page.keyboard.press('Delete');
  await note.waitFor({ state: 'detached' });
  for (let n = 0; n < 4; n++) await page.keyboard.press('Control+z');
  await says(page, /^input a, b : BOOL\nchart G1 \{[^"]*\}\n$/);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('the steps of a transition are chosen in the properties', async () => {
  const page = await open(b, site, 'loop.g7');
  await press(page, 'G1/t/0');
  await page.getByLabel('Succeeding steps 1').selectOption('2');
  await says(page, /0 -> 2 when a/);
  await page.getByLabel('Preceding steps: Add a step…').selectOption('1');
  await says(page, /\(0, 1\) -> 2 when a/);
  await page.getByLabel(/: 0$/).first().click();
  await says(page, /\n {2}1 -> 2 when a/);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('the rules of the profile are set one by one', async () => {
  const page = await open(b, site, 'loop.g7');
  await page.getByText('Rules', { exact: true }).click();
  await page.getByLabel('stable / one-pass').selectOption('one-pass');
  await says(page, /^profile iec60848 \{ one-pass \}/);
  await page.getByLabel('Most passes in a scan').fill('50');
  await page.getByLabel('Most passes in a scan').press('Enter');
  await says(page, /^profile iec60848 \{ one-pass, bound 50 \}/);
  await page.getByLabel('stable / one-pass').selectOption('');
  await says(page, /^profile iec60848 \{ bound 50 \}/);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('a receptivity is seen and written in each language of controllers', async () => {
  const page = await open(b, site, 'loop.g7');
  await press(page, 'G1/t/0');
  const logic = page.getByRole('region', { name: 'Logic', exact: true });
  await logic.getByRole('button', { name: 'LD' }).click();
  await logic.locator('svg text', { hasText: /^a$/ }).waitFor();
  await logic.getByRole('button', { name: 'IL' }).click();
  const list = logic.getByRole('textbox', { name: 'Instruction List' });
  assert.equal((await list.inputValue()).trim().replace(/\s+/g, ' '), 'LD a');
  await list.fill('LD a\nAND )');
  await list.blur();
  assert.match(await logic.getByRole('alert').innerText(), /line 2/);
  await list.fill('LDN a\nOR b');
  await list.blur();
  await says(page, /0 -> 1 when not a or b/);
  await logic.getByRole('button', { name: 'LD' }).click();
  const rungs = logic.getByRole('textbox', { name: 'Ladder' });
  await rungs.fill('--{ [a] | [/b] }');
  await rungs.blur();
  await says(page, /0 -> 1 when a or not b/);
  assert.deepEqual(await axe(page), []);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});
