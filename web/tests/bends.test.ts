// Stories of the bends of links: a segment is moved with the mouse, the keys or a finger, the text keeps it, and the
// layout takes it back.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { telephone } from './finger';
import { axe, box, browser, done, drawn, item, open, playground, textOf, until, type Site } from './lib';

const CHART = `input a, b : BOOL
chart G1 {
  initial step 0
  step 1
  step 2
  0 -> 1 when a
  0 -> 2 when b
  1 -> 0 when a
  2 -> 0 when b
}
`;
const BACK = 'G1/l/t:3>s:0';
const ENTRY = /\n\nlayout G1 \{\n  link transition #3 -> step 0 at \((-?[\d.]+), (-?[\d.]+)\), \((-?[\d.]+), (-?[\d.]+)\)\n\}\n$/;

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'chart.g7': CHART });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

const handle = (page: Page, n: number) => page.locator(`[data-bend="${n}"]`);

/** Selects the way back from the second transition by the key for links. */
async function chooseBack(page: Page): Promise<void> {
  const [x, y] = await middle(page, 'G1/t/3');
  await page.mouse.click(x, y);
  await page.locator('.marks .selected').first().waitFor({ state: 'attached' });
  for (let n = 0; n < 2; n++) await page.keyboard.press('l');
  await handle(page, 2).waitFor();
}

async function middle(page: Page, id: string): Promise<[number, number]> {
  await drawn(page);
  const { x, y, width, height } = await box(item(page, id).locator('.g7-box, .g7-bar').first());
  return [x + width / 2, y + height / 2];
}

/** The numbers of the entry of the layout section, once it is there. */
async function bends(page: Page, fits: (numbers: number[]) => boolean = () => true): Promise<number[]> {
  let numbers: number[] = [];
  await until(async () => {
    const found = ENTRY.exec(await textOf(page));
    numbers = (found?.slice(1) ?? []).map(Number);
    return found !== null && fits(numbers);
  }, 'the bends are in the text');
  return numbers;
}

/** Drags a handle by px of the screen. */
async function drag(page: Page, n: number, dx: number, dy: number): Promise<void> {
  const at = await box(handle(page, n));
  const [x, y] = [at.x + at.width / 2, at.y + at.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + dx, y + dy, { steps: 6 });
  await page.mouse.up();
  await drawn(page);
}

test('a segment of a link is dragged, the text keeps it, and one step undoes it', async () => {
  const page = await open(b, site, 'chart.g7');
  await chooseBack(page);
  const was = await box(handle(page, 1));
  // The part that runs upward goes sideways, however the pointer moves.
  await drag(page, 1, -60, 25);
  const [column = 0, row, , entry] = await bends(page);
  const now = await box(handle(page, 1));
  assert.ok(Math.abs(now.x - was.x + 60) < 4, `it went from ${was.x} to ${now.x}`);
  // A part that goes sideways is moved up and down; the others keep their places.
  await drag(page, 0, 30, 20);
  const after = await bends(page, (n) => n[1] !== row);
  assert.deepEqual(after, [column, (row ?? 0) + 2, after[2], entry]);
  await page.keyboard.press('Control+z');
  await bends(page, (n) => n[1] === row && n[0] === column);
  await page.keyboard.press('Control+z');
  await until(async () => (await textOf(page)) === CHART, 'the text is the first one');
  await done(page);
});

test('a link goes the way of the layout again by the panel and by a key', async () => {
  const page = await open(b, site, 'chart.g7');
  await chooseBack(page);
  const way = page.getByRole('button', { name: 'Link by the automatic layout' });
  assert.equal(await way.count(), 0, 'it is offered where there are bends alone');
  await drag(page, 1, -60, 0);
  await bends(page);
  await page.locator('.inspector').getByRole('button', { name: 'Link by the automatic layout' }).click();
  await until(async () => (await textOf(page)) === CHART, 'the panel took the bends away');
  await drag(page, 1, -60, 0);
  await bends(page);
  await handle(page, 1).focus();
  await page.keyboard.press('Delete');
  await until(async () => (await textOf(page)) === CHART, 'the key took the bends away');
  assert.equal(await item(page, BACK).count(), 1, 'the link is still there');
  await done(page);
});

test('a handle has a name, a place and arrow keys', async () => {
  const page = await open(b, site, 'chart.g7');
  await chooseBack(page);
  const upward = page.getByRole('slider', { name: 'Bend 2 of 3' });
  assert.equal(await upward.getAttribute('aria-orientation'), 'horizontal');
  const was = Number(await upward.getAttribute('aria-valuenow'));
  await upward.focus();
  await page.keyboard.press('ArrowLeft');
  await until(async () => Number(await upward.getAttribute('aria-valuenow')) === was - 0.5, 'an arrow key moves it');
  await page.keyboard.press('ArrowLeft');
  await until(async () => Number(await upward.getAttribute('aria-valuenow')) === was - 1, 'and once more, so it has kept the focus');
  await page.keyboard.press('ArrowUp');
  const [column] = await bends(page);
  assert.equal(column, was - 1, 'the other keys do not move it');
  assert.deepEqual(await axe(page), []);
  await done(page);
});

test('bends that do not fit are refused, and give way when the chart changes', async () => {
  const page = await open(b, site, 'chart.g7');
  await chooseBack(page);
  const was = await box(handle(page, 1));
  // Into the column of the steps.
  const [x] = await middle(page, 'G1/s/1');
  await drag(page, 1, x - was.x - was.width / 2, 0);
  await page.getByText('the link has no room there').first().waitFor();
  assert.equal(await textOf(page), CHART);
  await drag(page, 1, -60, 0);
  await bends(page);
  // A step that comes to stand in its way.
  await page.keyboard.press('Escape');
  const [sx, sy] = await middle(page, 'G1/s/1');
  await page.mouse.move(sx, sy);
  await page.mouse.down();
  await page.keyboard.down('Alt');
  await page.mouse.move(was.x + was.width / 2 - 60, sy, { steps: 8 });
  await page.mouse.up();
  await page.keyboard.up('Alt');
  await until(async () => /step 1 at/.test(await textOf(page)), 'the step is moved');
  await drawn(page);
  await chooseBack(page);
  await page.getByText('Its bends do not fit here at present').waitFor();
  await page.keyboard.press('Control+z');
  await until(async () => !/step 1 at/.test(await textOf(page)), 'the step is back');
  await page.getByText('Its bends do not fit here at present').waitFor({ state: 'detached' });
  await done(page);
});

test('a finger drags a segment', async () => {
  const hand = await telephone(b, site, 'chart.g7');
  const { page } = hand;
  await drawn(page);
  // The link itself, where nothing else is.
  const line = await box(item(page, BACK));
  await hand.tap([line.x + 2, line.y + line.height / 2]);
  await handle(page, 1).waitFor();
  const [x, y] = await hand.middle(handle(page, 1));
  await hand.slide([[x, y]], [[x - 40, y]]);
  // It is bent, and the link can be given back to the layout.
  await page.locator('.near').getByRole('button', { name: 'Link by the automatic layout' }).waitFor();
  await until(async () => (await hand.middle(handle(page, 1)))[0] < x - 25, 'the handle has moved');
  await page.context().close();
});
