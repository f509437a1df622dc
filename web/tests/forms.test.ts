// Stories of forms: a link as a jump or a line, actions side by side, and the charts of a file on one sheet.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { axe, box, browser, done, drawn, item, open, playground, textOf, until, type Site } from './lib';

const CHART = `input a, b : BOOL
output m, n : BOOL

chart G1 {
  initial step 0 { N m; N n if a }
  step 1
  step 2
  0 -> 1 when a
  0 -> 2 when b
  1 -> 0 when a
  2 -> 0 when b
}

chart G2 {
  initial step 10
  step 11 { N m }
  10 -> 11 when a
  11 -> 10 when b
}
`;
const MACRO = `input a : BOOL

chart Main {
  initial step 0
  macro step M1 = Fill
  0 -> M1 when a
  M1 -> 0 when not a
}

macrochart Fill {
  entry step E1
  step 1
  exit step S1
  E1 -> 1 when a
  1 -> S1 when not a
}
`;
const BACK = 'G1/l/t:3>s:0';

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'chart.g7': CHART, 'macro.g7': MACRO });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

async function choose(page: Page, id: string): Promise<void> {
  await drawn(page);
  const { x, y, width, height } = await box(item(page, id).locator('.g7-box, .g7-bar, .g7-title').first());
  await page.mouse.click(x + width / 2, y + height / 2);
  await page.locator('.marks .selected').first().waitFor({ state: 'attached' });
}

test('a link becomes a jump by a key, and a line again by the properties', async () => {
  const page = await open(b, site, 'chart.g7');
  await choose(page, 'G1/t/3');
  for (let n = 0; n < 2; n++) await page.keyboard.press('l');
  await page.keyboard.press('j');
  await until(async () => (await textOf(page)).endsWith('\n\nlayout G1 {\n  link transition #3 -> step 0 as jump\n}\n'), 'the jump is in the text');
  await drawn(page);
  assert.equal(await item(page, BACK).count(), 0, 'it is no line any more');
  const ends = page.locator('[data-id="G1/c/t:3>s:0/leaving"], [data-id="G1/c/t:3>s:0/arriving"]');
  assert.equal(await ends.count(), 2, 'it has two ends');
  // The end at its start is selected, and tells the form.
  const form = page.getByRole('combobox', { name: 'Drawn as' });
  assert.equal(await form.inputValue(), 'jump');
  assert.deepEqual(await axe(page), []);
  await form.selectOption('line');
  await until(async () => (await textOf(page)).includes('link transition #3 -> step 0 as line'), 'the line is in the text');
  await item(page, BACK).waitFor({ state: 'attached' });
  await form.selectOption('');
  await until(async () => (await textOf(page)) === CHART, 'the layout decides again');
  await done(page);
});

test('actions stand side by side: those of a step, and those of the chart', async () => {
  const page = await open(b, site, 'chart.g7');
  await drawn(page);
  const tops = async () => Promise.all([0, 1].map(async (n) => (await box(item(page, `G1/a/0/${n}`).locator('.g7-action'))).y));
  const [first = 0, second = 0] = await tops();
  assert.ok(second > first + 10, 'one stands below the other at first');
  const stand = page.getByRole('combobox', { name: 'Actions stand' });
  await stand.selectOption('row');
  await until(async () => (await textOf(page)).includes('layout G1 {\n  actions in row\n}'), 'the chart has them in a row');
  await drawn(page);
  const [left = 0, right = -1] = await tops();
  assert.ok(Math.abs(left - right) < 1, 'they stand at one height');
  await choose(page, 'G1/s/0');
  await stand.selectOption('column');
  await until(async () => (await textOf(page)).includes('actions of step 0 in column'), 'the step has its own form');
  await drawn(page);
  const [up = 0, down = 0] = await tops();
  assert.ok(down > up + 10, 'its actions stand below one another again');
  await page.keyboard.press('Escape');
  for (let n = 0; n < 2; n++) await page.keyboard.press('Control+z');
  await until(async () => (await textOf(page)) === CHART, 'the text is the first one');
  await done(page);
});

test('the charts of a file stand on one sheet, are arranged by their titles and edited there', async () => {
  const page = await open(b, site, 'chart.g7');
  await page.getByRole('button', { name: 'All charts' }).click();
  await drawn(page);
  for (const id of ['G1', 'G2', 'G1/s/0', 'G2/s/10']) assert.equal(await item(page, id).count(), 1, id);
  const was = await box(item(page, 'G2/s/10').locator('.g7-box').first());
  const other = await box(item(page, 'G1/s/0').locator('.g7-box').first());
  const title = await box(item(page, 'G2').locator('.g7-title'));
  const [x, y] = [title.x + title.width / 2, title.y + title.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 60, y + 40, { steps: 6 });
  await page.mouse.up();
  await until(async () => /layout G2 \{\n {2}sheet at \(-?[\d.]+, -?[\d.]+\)\n\}\n$/.test(await textOf(page)), 'the place is in the text');
  await drawn(page);
  const now = await box(item(page, 'G2/s/10').locator('.g7-box').first());
  const stays = await box(item(page, 'G1/s/0').locator('.g7-box').first());
  // The sheet may be shown at another place of the window; the charts keep their distance to each other.
  assert.ok(Math.abs(now.x - was.x - 60 - (stays.x - other.x)) < 5, `${now.x} ${was.x}`);
  assert.ok(Math.abs(now.y - was.y - 40 - (stays.y - other.y)) < 5, `${now.y} ${was.y}`);
  assert.deepEqual(await axe(page), []);
  // A gesture at a symbol is one of its chart.
  await choose(page, 'G2/s/11');
  await page.keyboard.press('Tab');
  await until(async () => /11 -> 12 when/.test(await textOf(page)), 'a step follows in the chart of the symbol');
  await page.keyboard.press('Escape');
  await page.keyboard.press('Escape');
  // A new step belongs to no chart: it is refused with the words where it is done.
  await page.keyboard.press('Insert');
  await page.getByText('Several charts are on this sheet').first().waitFor();
  // Back to rows, and into a chart by its title.
  await page.getByRole('button', { name: 'Arrange in rows' }).click();
  await until(async () => !/sheet at/.test(await textOf(page)), 'no chart has a place any more');
  await drawn(page);
  // A run shows all charts.
  await page.keyboard.press('Control+z');
  await page.keyboard.press('Control+z');
  await page.getByRole('button', { name: 'Run', exact: true }).click();
  for (const id of ['G1/s/0', 'G2/s/10']) {
    await until(async () => /active/.test((await item(page, id).getAttribute('aria-label')) ?? ''), `${id} is active`);
  }
  await choose(page, 'G2');
  await page.keyboard.press('Enter');
  await until(async () => (await item(page, 'G1/s/0').count()) === 0, 'only the opened chart is shown');
  assert.equal(await item(page, 'G2/s/10').count(), 1);
  await done(page);
});

test('the expansion of a macro-step opens beside it, and closes by the same key', async () => {
  const page = await open(b, site, 'macro.g7');
  await choose(page, 'Main/s/M1');
  await page.keyboard.press('e');
  await item(page, 'Fill/s/E1').waitFor({ state: 'attached' });
  await drawn(page);
  for (const id of ['Main/s/0', 'Main/s/M1', 'Fill/s/1', 'Fill/s/S1', 'Fill']) assert.equal(await item(page, id).count(), 1, id);
  const [outer, inner] = [await box(item(page, 'Main/s/M1').locator('.g7-box').first()), await box(item(page, 'Fill/s/E1').locator('.g7-box').first())];
  assert.ok(inner.x > outer.x + outer.width, 'it stands at the right of its macro-step');
  assert.equal(await textOf(page), MACRO, 'no file keeps it');
  // A gesture in the expansion is one of the expansion.
  await choose(page, 'Fill/s/1');
  await page.keyboard.press('i');
  await until(async () => /initial step 1/.test(await textOf(page)), 'the step of the expansion is initial');
  await page.keyboard.press('Control+z');
  await until(async () => (await textOf(page)) === MACRO, 'and is not any more');
  await choose(page, 'Main/s/M1');
  await page.keyboard.press('e');
  await until(async () => (await item(page, 'Fill/s/E1').count()) === 0, 'it is closed again');
  await done(page);
});
