// Stories of the frame round the drawing: new charts, many open files, the list of steps to jump to.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { axe, box, browser, done, drawn, item, open, openWith, playground, press, textOf, until, type Site } from './lib';

const SMALL = 'chart G1 {\n  initial step 0\n}\n';
const NAMES = Array.from({ length: 14 }, (_, n) => `a-machine-with-a-long-name-${n + 1}.g7`);

const chain = (count: number): string => {
  const steps = Array.from({ length: count }, (_, n) => `  ${n === 0 ? 'initial ' : ''}step ${n}\n`);
  const transitions = Array.from({ length: count - 1 }, (_, n) => `  ${n} -> ${n + 1} when a\n`);
  return `input a : BOOL\nchart G1 {\n${steps.join('')}${transitions.join('')}}\n`;
};
const CHAIN = chain(120);
/** As a whole, it is drawn smaller than the wheel makes it. */
const TALL = chain(1200);

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'chain.g7': CHAIN, 'tall.g7': TALL, ...Object.fromEntries(NAMES.map((name) => [name, SMALL])) });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

const current = (page: Page) => page.getByRole('tab', { selected: true }).filter({ hasText: 'machine' });

/** Opens the first files, so that the last of them is visible. */
async function openAll(page: Page, names: string[]): Promise<void> {
  for (const name of names) {
    await page.locator('.file', { hasText: new RegExp(`^\\s*${name}\\s*$`) }).click();
    await current(page).filter({ hasText: name }).waitFor();
  }
}

test('a new chart is shown, and the next key goes to its drawing', async () => {
  const page = await open(b, site, 'chain.g7');
  await page.getByRole('button', { name: 'New chart' }).click();
  await item(page, 'Chart/s/1').waitFor();
  await until(() => page.evaluate(() => document.activeElement?.getAttribute('role') === 'application'), 'the drawing has the keys');
  await page.locator('.marks .selected').first().waitFor({ state: 'attached' });
  await page.keyboard.press('F2');
  await page.locator('.inplace > input').fill('Wait');
  await page.keyboard.press('Enter');
  await drawn(page);
  assert.match(await textOf(page), /chart Chart \{\n {2}initial step Wait\n\}/);
  await done(page);
});

test('a new file has the keys on its drawing', async () => {
  const page = await open(b, site, 'chain.g7');
  await page.getByRole('button', { name: 'New file' }).click();
  await item(page, 'G1/s/0').waitFor();
  await until(() => page.evaluate(() => document.activeElement?.getAttribute('role') === 'application'), 'the drawing has the keys');
  await done(page);
});

test('the steps to jump to are found by typing', async () => {
  const page = await open(b, site, 'chain.g7');
  await press(page, 'G1/s/1');
  await page.keyboard.press('j');
  const dialog = page.getByRole('dialog', { name: 'Jump to a step' });
  assert.equal(await dialog.locator('.step').count(), 120);
  await page.keyboard.type('1');
  // A step whose name begins with it comes before one that has it inside.
  assert.deepEqual((await dialog.locator('.step').allTextContents()).slice(0, 3).map((text) => /\d+/.exec(text)?.[0]), ['1', '10', '11']);
  await page.keyboard.type('13');
  assert.equal(await dialog.locator('.step').count(), 1);
  await page.keyboard.type('x');
  await dialog.getByText('Nothing found.').waitFor();
  assert.deepEqual(await axe(page), []);
  await page.keyboard.press('Backspace');
  await page.keyboard.press('Enter');
  await drawn(page);
  assert.match(await textOf(page), / 1 -> 113 /);
  await done(page);
});

test('a chart of thousands of steps is shown as a whole, and the wheel goes on from there', async () => {
  const page = await open(b, site, 'tall.g7');
  await page.locator('.sheet').focus();
  await page.keyboard.press('f');
  const inSight = () =>
    page.evaluate(() => {
      const sheet = document.querySelector('.sheet')?.getBoundingClientRect();
      const all = [...document.querySelectorAll('.still *')].map((e) => e.getBoundingClientRect()).filter((r) => r.width > 0 || r.height > 0);
      const [top, low] = [Math.min(...all.map((r) => r.top)), Math.max(...all.map((r) => r.bottom))];
      return sheet !== undefined && top >= sheet.top && low <= sheet.bottom && low - top > sheet.height * 0.7;
    });
  await until(inSight, 'the chart fills the sheet and does not leave it');
  await page.mouse.move(640, 300);
  await page.keyboard.down('Control');
  await page.mouse.wheel(0, -400);
  await page.keyboard.up('Control');
  await until(async () => !(await inSight()), 'the wheel goes nearer');
  await done(page);
});

for (const width of [1280, 390]) {
  test(`many open files are a list, and the tab of the visible one is seen (${width} px)`, async () => {
    const page = await openWith(b, site, NAMES[0] as string, { leftOpen: true, view: 'chart' }, { width: 1280, height: 720 });
    const all = page.getByRole('button', { name: /^Open files: / });
    await openAll(page, NAMES.slice(0, 2));
    assert.equal(await all.count(), 0, 'two tabs have room');
    await openAll(page, NAMES);
    await page.setViewportSize({ width, height: 720 });
    await all.waitFor();
    const seen = async () => {
      const [tab, list] = [await box(current(page)), await box(page.getByRole('tablist', { name: 'Open files' }))];
      return tab.x >= list.x - 1 && tab.x + Math.min(tab.width, list.width) <= list.x + list.width + 1;
    };
    await until(seen, 'the tab of the last file is seen');
    await all.click();
    const menu = page.getByRole('menu', { name: 'Open files' });
    assert.equal(await menu.getByRole('menuitemradio').count(), 14);
    await until(() => page.evaluate(() => document.activeElement?.getAttribute('aria-checked') === 'true'), 'the list begins at the visible file');
    assert.deepEqual(await axe(page), []);
    await page.keyboard.press('Home');
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('Enter');
    await current(page).filter({ hasText: NAMES[1] as string }).waitFor();
    await until(seen, 'the tab of the second file is seen');
    assert.equal(await menu.count(), 0);
    await all.click();
    await page.keyboard.press('Escape');
    assert.equal(await menu.count(), 0);
    assert.ok(await all.evaluate((e) => e === document.activeElement), 'Escape gives the keys back');
    await done(page);
  });
}
