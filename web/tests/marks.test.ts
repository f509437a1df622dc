// Elements over the drawing cover nothing that must be readable: tokens, times, values, frames of
// problems, notes, buttons; and the view follows the run.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { Transitions } from '../src/run/transitions';
import type { Item } from '../src/lib/protocol';
import { box, browser, drawn, item, open, playground, press, until, type Box, type Site } from './lib';

const CHART = `input a : BOOL
output lamp, motor : BOOL
var temperature_of_the_second_tank, n : INT

chart G1 {
  initial step WaitForBottle
  step FillTheTank { N lamp  N motor if temperature_of_the_second_tank > 3 }
  step 2
  WaitForBottle -> FillTheTank when a
  FillTheTank -> 2 when temperature_of_the_second_tank + n > 5 and not a
  2 -> WaitForBottle when n > 1000
}
`;

// Under unity one transition is cleared in a scan, under iec60848 all possible ones.
const FLEETING = `input a : BOOL
chart G1 {
  initial step 0
  step 1
  step 2
  0 -> 1 when a
  1 -> 2 when a
  2 -> 0 when not a
}
`;

const COUNT = `input a : BOOL
var count : INT
chart G1 {
  initial step 0
  step 1
  step 2
  0 -> 1 when a
  1 -> 2 when count >= 3
  2 -> 0 when not a
}
`;

const WRONG = CHART.replace('  step 2\n', '  step 2 { N missing }\n');

const LONG = `chart G1 {
  initial step 0
${Array.from({ length: 39 }, (_, n) => `  step ${n + 1}`).join('\n')}
${Array.from({ length: 39 }, (_, n) => `  ${n} -> ${n + 1} when 100ms/X${n}`).join('\n')}
}
`;

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'chart.g7': CHART, 'fleeting.g7': FLEETING, 'count.g7': COUNT, 'wrong.g7': WRONG, 'long.g7': LONG });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

const oneScan = (page: Page) => page.getByRole('button', { name: 'One scan', exact: true }).click();

function apart(one: Box, other: Box): boolean {
  return one.x + one.width <= other.x || other.x + other.width <= one.x || one.y + one.height <= other.y || other.y + other.height <= one.y;
}

async function end(page: Page & { errors: string[] }): Promise<void> {
  assert.deepEqual(page.errors, []);
  await page.context().close();
}

test('a token leaves a name of two lines free', async () => {
  const page = await open(b, site, 'chart.g7');
  await oneScan(page);
  await page.waitForFunction(() => document.querySelector('.live .token')?.getAttribute('d'));
  const token = await box(page.locator('.live .token'));
  const lines = item(page, 'G1/s/WaitForBottle').locator('.g7-name');
  assert.equal(await lines.count(), 2);
  const second = await lines.nth(1).evaluate((e) => {
    // The base line; none of these letters reaches below it.
    const { x, y } = new DOMPoint(Number(e.getAttribute('x')), Number(e.getAttribute('y'))).matrixTransform((e as SVGTextElement).getScreenCTM() ?? undefined);
    return { x, y };
  });
  assert.ok(token.y > second.y, `the token begins at ${token.y}, the name ends at ${second.y}`);
  await end(page);
});

test('a value stands without a name where one name is written, else with a short one', async () => {
  const page = await open(b, site, 'chart.g7');
  await oneScan(page);
  await page.getByRole('switch', { name: 'a', exact: true }).click();
  await oneScan(page);
  const shown = () => page.locator('.live .value').evaluateAll((all) => all.map((e) => e.textContent).filter((text) => text !== ''));
  await page.waitForFunction(() => [...document.querySelectorAll('.live .value')].some((e) => e.textContent !== ''));
  const texts = await shown();
  assert.ok(texts.some((text) => /^temperatu…d_tank = 0 {3}n = 0$/.test(text ?? '')), texts.join(' | '));
  assert.ok(texts.every((text) => (text ?? '').length < 40), texts.join(' | '));
  await end(page);
});

test('the other run of a comparison has a mark of its own, which goes with it', async () => {
  const page = await open(b, site, 'fleeting.g7');
  await page.getByRole('button', { name: 'Compare profiles' }).click();
  await page.getByRole('button', { name: 'Compare with unity' }).click();
  await page.getByText('no difference so far').first().waitFor();
  await page.getByRole('switch', { name: 'a', exact: true }).click();
  await oneScan(page);
  await page.waitForFunction(() => document.querySelector('.live .other')?.getAttribute('d'));
  const square = await box(item(page, 'G1/s/1').locator('.g7-box'));
  const label = await box(page.locator('.live .time.other').filter({ hasText: 'unity' }));
  assert.ok(label.y + label.height <= square.y + 4, 'the label stands above its step');
  // After a restart both runs begin from the start.
  await page.getByRole('switch', { name: 'a', exact: true }).click();
  await page.getByRole('button', { name: 'Restart' }).click();
  await page.getByText('no difference so far').first().waitFor();
  if (!(await page.getByRole('button', { name: 'End the comparison' }).isVisible())) await page.getByRole('button', { name: 'Compare profiles' }).click();
  await page.getByRole('button', { name: 'End the comparison' }).click();
  await page.waitForFunction(() => document.querySelector('.live path.other')?.getAttribute('d') === '');
  assert.equal(await page.locator('.live .time.other').evaluateAll((all) => all.map((e) => e.textContent).join('')), '');
  await end(page);
});

test('what is wrong with an action is framed clear of its step, and told beside it', async () => {
  const page = await open(b, site, 'wrong.g7', { width: 1024, height: 768 });
  const frame = await box(page.locator('.marks .problem').first());
  const step = await box(item(page, 'G1/s/2').locator('.g7-box'));
  assert.ok(frame.x > step.x + step.width, 'the frame is clear of the step');
  await press(page, 'G1/a/2/0');
  const note = page.locator('.note');
  await note.waitFor();
  assert.equal(await note.locator('code').first().innerText(), 'missing');
  assert.ok(!(await note.innerText()).includes('`'));
  const over = await box(note);
  for (const id of ['G1/a/2/0', 'G1/s/2']) assert.ok(apart(over, await box(item(page, id).locator('.g7-box, .g7-action').first())), `the note leaves ${id} free`);
  assert.ok(apart(over, await box(page.locator('.near'))), 'and the buttons');
  await end(page);
});

test('the buttons at a symbol leave the palette and its time free', async () => {
  const context = await b.newContext({ viewport: { width: 1024, height: 768 }, locale: 'en-GB', hasTouch: true, isMobile: true });
  const page = await context.newPage();
  await page.goto(`${site.url}?file=chart.g7`);
  await item(page, 'G1/s/WaitForBottle').waitFor({ state: 'attached' });
  await oneScan(page);
  await page.waitForFunction(() => document.querySelector('.live .time')?.textContent);
  for (const id of ['G1/s/WaitForBottle', 'G1/t/0', 'G1/s/FillTheTank', 'G1/s/2']) {
    await press(page, id);
    await page.waitForTimeout(100);
    const near = await box(page.locator('.near'));
    assert.ok(apart(near, await box(page.locator('.palette'))), `${id}: the palette`);
    assert.ok(apart(near, await box(page.locator('.live .time').first())), `${id}: the time`);
    assert.ok(apart(near, await box(item(page, id).locator('.g7-box, .g7-bar').first())), `${id}: itself`);
  }
  await context.close();
});

test('the menu of a step sets a breakpoint and says that it is set', async () => {
  const page = await open(b, site, 'chart.g7');
  for (const id of ['G1/s/2', 'G1/t/1']) {
    const entry = page.getByRole('menuitemcheckbox', { name: 'Breakpoint' });
    await press(page, id);
    await page.keyboard.press('Shift+F10');
    assert.equal(await entry.getAttribute('aria-checked'), 'false');
    await entry.click();
    await page.getByRole('button', { name: 'Breakpoints 1' }).waitFor();
    await page.keyboard.press('Shift+F10');
    assert.equal(await entry.getAttribute('aria-checked'), 'true');
    await entry.click();
    await page.getByRole('button', { name: 'Breakpoints', exact: true }).waitFor();
  }
  await end(page);
});

test('each problem of the list has its page', async () => {
  const page = await open(b, site, 'wrong.g7');
  await page.getByRole('button', { name: 'Bottom' }).click();
  await page.getByRole('button', { name: 'Explain: G0202' }).click();
  const about = page.getByRole('dialog', { name: 'G0202' });
  await about.getByRole('heading', { name: 'How to mend it' }).waitFor();
  assert.ok((await about.locator('pre').count()) >= 2, 'a wrong chart and a right one');
  assert.equal((await about.innerText()).match(/Source:/g)?.length, 1);
  await page.keyboard.press('Escape');
  await about.waitFor({ state: 'detached' });
  await end(page);
});

test('the view goes along with the active step, if wished', async () => {
  const page = await open(b, site, 'long.g7');
  await page.getByRole('button', { name: 'Zoom 60 %' }).or(page.locator('.zoom .percent')).first().click();
  await page.getByRole('button', { name: 'Follow the active steps' }).click();
  await page.getByRole('combobox', { name: 'Speed' }).selectOption('5');
  await page.getByRole('button', { name: 'Run', exact: true }).click();
  await page.waitForFunction(() => document.querySelector('.steps button.on')?.textContent?.trim() === '39', null, { timeout: 20_000 });
  const sheet = await box(page.locator('.sheet'));
  await until(async () => !apart(sheet, await box(item(page, 'G1/s/39').locator('.g7-box'))), 'the last step is in sight');
  await end(page);
});

test('the chronogram is zoomed by keys and by two fingers', async () => {
  const context = await b.newContext({ viewport: { width: 1024, height: 768 }, locale: 'en-GB', hasTouch: true });
  const page = await context.newPage();
  await page.goto(`${site.url}?file=fleeting.g7`);
  await item(page, 'G1/s/0').waitFor({ state: 'attached' });
  for (let n = 0; n < 5; n++) await oneScan(page);
  await page.getByRole('button', { name: 'Bottom' }).click();
  await page.getByRole('tab', { name: 'Chronogram' }).click();
  await page.getByRole('button', { name: 'Whole run' }).click();
  const lanes = page.locator('[role=group][aria-label^=Chronogram]');
  const wide = async () => {
    const [from = 0, to = 0] = ((await lanes.getAttribute('aria-label')) ?? '').match(/-?\d+\.\d+(?= s)/g)?.map(Number) ?? [];
    return to - from;
  };
  const whole = await wide();
  await lanes.focus();
  await page.keyboard.press('+');
  await page.keyboard.press('+');
  const near = await wide();
  assert.ok(Math.abs(near - whole / 1.96) < 0.003, `${whole} s, then ${near} s`);
  await page.keyboard.press('-');
  await page.keyboard.press('-');
  const at = await box(lanes.locator('canvas').last());
  const finger = await context.newCDPSession(page);
  const touch = (type: 'touchStart' | 'touchMove' | 'touchEnd', apart?: number) => {
    const y = at.y + 20;
    const touchPoints = apart === undefined ? [] : [{ x: at.x + 200 - apart, y, id: 0 }, { x: at.x + 200 + apart, y, id: 1 }];
    return finger.send('Input.dispatchTouchEvent', { type, touchPoints });
  };
  const before = await wide();
  await touch('touchStart', 40);
  for (let n = 1; n <= 8; n++) await touch('touchMove', 40 + n * 5);
  await touch('touchEnd');
  await until(async () => Math.abs((await wide()) - before / 2) < before * 0.1, `half of ${before} s are in sight`);
  assert.equal(await page.locator('.cursors b').count(), 0);
  await context.close();
});

/** A transition of a drawing, as far as it is looked at. */
const transition = (number: number, from: string, to: string, source: string, label?: string): Item =>
  ({ id: `G1/t/${number}`, part: 'transition', steps: [[from], [to]], source, ...(label === undefined ? {} : { label }) }) as unknown as Item;

test('marks of transitions follow their steps and receptivities while the text is another one', () => {
  const found = new Transitions();
  const was = [transition(0, '0', '1', 'a'), transition(1, '1', '2', 'b'), transition(2, '1', '2', 'c'), transition(3, '2', '0', 'd'), transition(4, '2', '3', 'e', 'last')];
  found.show('G1', was, true);
  const all = () => was.map(({ id }) => found.of(id));
  assert.deepEqual(all(), was.map(({ id }) => id));
  // The first one is gone, one has another receptivity, and one with a label has other steps.
  found.show('G1', [transition(0, '1', '2', 'c'), transition(1, '1', '2', 'b'), transition(2, '2', '0', 'not d'), transition(3, '5', '3', 'e', 'last')], false);
  assert.deepEqual(all(), [null, 'G1/t/1', 'G1/t/0', 'G1/t/2', 'G1/t/3']);
  // Two between the same steps have both changed: it is not known which is which.
  found.show('G1', [transition(0, '1', '2', 'x'), transition(1, '1', '2', 'y')], false);
  assert.deepEqual(all(), [null, null, null, null, null]);
  found.show('G1', was, true);
  assert.deepEqual(all(), was.map(({ id }) => id));
  // A chart that was never drawn while text and run agreed has no marks that could be wrong.
  found.show('G2', [], false);
  assert.deepEqual([found.of('G2/t/0'), found.of('G3/t/0')], [null, 'G3/t/0']);
});

test('an enabled transition is that of the active step, also when a step before it is deleted', async () => {
  const page = await open(b, site, 'count.g7');
  await oneScan(page);
  const mark = page.locator('.live .enabled');
  await until(async () => !!(await mark.getAttribute('d')), 'the first transition is enabled');
  await press(page, 'G1/s/0');
  await page.keyboard.press('Delete');
  await drawn(page);
  await page.getByRole('button', { name: 'Go on with the earlier chart' }).click();
  await item(page, 'G1/s/1').waitFor();
  await until(async () => !(await mark.getAttribute('d')) && !(await page.locator('.live .holds').getAttribute('d')), 'no transition behind an inactive step is enabled');
  await end(page);
});
