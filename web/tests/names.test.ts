// Stories of names that nothing declares: they declare themselves in the field, in the drawing, in the list of problems
// and in the text.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { axe, browser, done, item, open, openWith, playground, press, textOf, until, type Site } from './lib';

const BARE = `chart G1 {
  initial step 0
  step 1
  0 -> 1 when TRUE
  1 -> 0 when TRUE
}
`;
/** Fourteen names, each used in another way. */
const MANY = `chart Main {
  initial step 0
  step 1 {
    N motor
    P1 n := n + 1
    L (hold) lamp
    N valve if wet or depth > 2.0
    P1 total := total + depth * 2.0
  }
  step 2 { N horn }
  0 -> 1 when ↑go and 3s/ready and name = 'abc'
  1 -> 2 when go and temp > T#5s
  2 -> 0 when n >= 4 and limit < 10
}
`;
/** Twelve unused variables: more problems than eight. */
const UNUSED = `var ${Array.from({ length: 12 }, (_, n) => `u${n}`).join(', ')} : BOOL
chart G1 {
  initial step 0
  0 -> 0 when TRUE
}
`;

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'bare.g7': BARE, 'many.g7': MANY, 'unused.g7': UNUSED });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

const field = (page: Page) => page.locator('.inplace > input');
const names = (page: Page) => page.getByRole('group', { name: 'New names' });

/** Waits until the text matches. */
async function says(page: Page, wanted: RegExp): Promise<void> {
  let text = '';
  for (let n = 0; n < 20 && !wanted.test(text); n++) text = await textOf(page);
  assert.match(text, wanted);
}

test('a new name in a receptivity is declared as an input by one key, and one undo takes both back', async () => {
  const page = await open(b, site, 'bare.g7');
  await press(page, 'G1/t/0');
  await page.keyboard.press('Enter');
  await field(page).fill('↑start and level > 2.5');
  await names(page).getByLabel('Type of level').waitFor();
  assert.equal(await names(page).getByLabel('Class of start').inputValue(), 'input');
  assert.equal(await names(page).getByLabel('Type of start').inputValue(), 'BOOL');
  assert.equal(await names(page).getByLabel('Type of level').inputValue(), 'REAL');
  assert.deepEqual(await axe(page), []);
  await field(page).press('Control+Enter');
  await field(page).waitFor({ state: 'detached' });
  await says(page, /input start : BOOL\ninput level : REAL\n[^]*0 -> 1 when ↑start and level > 2\.5/);
  await page.locator('.sheet').focus();
  await page.keyboard.press('Control+z');
  await says(page, /^chart G1 \{\n {2}initial step 0\n {2}step 1\n {2}0 -> 1 when TRUE\n/);
  await done(page);
});

test('in an action a new name is an output, what counts is a variable, and class and type are chosen with the keys', async () => {
  const page = await open(b, site, 'bare.g7');
  await press(page, 'G1/s/1');
  await page.keyboard.press('a');
  await field(page).fill('motor');
  await names(page).getByLabel('Class of motor').waitFor();
  assert.equal(await names(page).getByLabel('Class of motor').inputValue(), 'output');
  await field(page).press('Control+Enter');
  await says(page, /output motor : BOOL\n/);
  await press(page, 'G1/s/1');
  await page.keyboard.press('a');
  await field(page).fill('n := n + 1');
  await names(page).getByLabel('Class of n').waitFor();
  assert.equal(await names(page).getByLabel('Class of n').inputValue(), 'var');
  assert.equal(await names(page).getByLabel('Type of n').inputValue(), 'INT');
  await field(page).press('ArrowDown');
  const chosen = page.locator('.inplace select:focus');
  await chosen.waitFor();
  await chosen.press('ArrowUp');
  await names(page).getByLabel('Type of n').fill('DINT');
  await names(page).getByLabel('Type of n').press('Enter');
  await field(page).waitFor({ state: 'detached' });
  await says(page, /output n : DINT\n/);
  await done(page);
});

test('Enter alone declares nothing; then D declares the names of the selected symbol', async () => {
  const page = await open(b, site, 'bare.g7');
  await press(page, 'G1/t/0');
  await page.keyboard.press('Enter');
  await field(page).fill('go');
  await field(page).press('Enter');
  await says(page, /^chart G1 \{[^]*0 -> 1 when go\n/);
  await press(page, 'G1/t/0');
  await page.getByRole('button', { name: 'Declare the new names' }).waitFor();
  await page.keyboard.press('d');
  await says(page, /^input go : BOOL\n/);
  await page.locator('.notice', { hasText: 'Declared: go' }).waitFor();
  assert.equal(await page.getByRole('button', { name: 'Declare the new names' }).count(), 0);
  await done(page);
});

test('one press declares all names, each as its use asks for', async () => {
  const page = await openWith(b, site, 'many.g7', { bottomOpen: true });
  const all = page.getByRole('button', { name: 'Declare all (14)' });
  await all.waitFor();
  assert.deepEqual(await axe(page), []);
  await all.click();
  await page.getByText('No problems').or(page.locator('.problems .warning').first()).first().waitFor();
  await all.waitFor({ state: 'detached' });
  const text = await textOf(page);
  const wanted = [
    'output motor : BOOL', 'var n : INT', 'input hold : TIME', 'output lamp : BOOL', 'output valve : BOOL', 'input wet : BOOL',
    'input depth : REAL', 'var total : REAL', 'output horn : BOOL', 'input go : BOOL', 'input ready : BOOL', 'input name : STRING',
    'input temp : TIME', 'input limit : INT',
  ];
  assert.deepEqual(wanted.filter((line) => !text.includes(`${line}\n`)), [], text);
  assert.equal(await page.locator('.problems .error').count(), 0);
  await page.locator('.sheet').focus();
  await page.keyboard.press('Control+z');
  await all.waitFor();
  await done(page);
});

test('every problem has its fixes', async () => {
  const page = await openWith(b, site, 'unused.g7', { bottomOpen: true });
  await page.getByRole('button', { name: 'Fix: delete u11' }).click();
  await page.getByRole('button', { name: 'Fix: delete u11' }).waitFor({ state: 'detached' });
  await says(page, /^var u0, u1, u2, u3, u4, u5, u6, u7, u8, u9, u10 : BOOL\n/);
  await done(page);
});

test('the list of problems is legible at 1280 and 1440 px', async () => {
  for (const width of [1280, 1440, 390]) {
    const page = await openWith(b, site, 'many.g7', { bottomOpen: true }, { width, height: 800 });
    await page.locator('.problems .what').first().waitFor();
    const heights = await page.locator('.problems .what').evaluateAll((list) => list.map((e) => e.getBoundingClientRect().height));
    // One line of text is about 20 px high; the longest message of this file needs no third one.
    assert.deepEqual(heights.filter((h) => h > 50), [], `${width}`);
    await done(page);
  }
});

test('in the text, Ctrl+. declares the name at the cursor', async () => {
  const page = await openWith(b, site, 'bare.g7', { view: 'both' });
  await press(page, 'G1/t/0');
  await page.keyboard.press('Enter');
  await field(page).fill('level > 2.5');
  await field(page).press('Enter');
  await item(page, 'G1/t/0').waitFor({ state: 'attached' });
  const line = page.locator('.cm-line', { hasText: 'level > 2.5' });
  await line.getByText('level', { exact: false }).first().click({ position: { x: 4, y: 4 } });
  await page.locator('.cm-content').press('Home');
  for (let n = 0; n < '0 -> 1 when le'.length; n++) await page.keyboard.press('ArrowRight');
  await until(async () => (await page.locator('.cm-lintRange-error').count()) > 0, 'the problem is not marked in the text');
  await page.keyboard.press('Control+.');
  await page.locator('.cm-line', { hasText: 'input level : REAL' }).waitFor();
  await done(page);
});
