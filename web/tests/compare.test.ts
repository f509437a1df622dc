// Stories of the panel *Compare*: two charts beside each other, up to the first difference.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { axe, browser, cells, done, drawn, inputs, openWith, playground, until, type Opened, type Site } from './lib';

/** Two scans lead to step 3. */
const LINE = `input go : BOOL
output M, N : BOOL
chart G {
  initial step 1
  step 2
  step 3 { N M }
  1 -> 2 when ↑go
  2 -> 3 when ↑go
  3 -> 1 when ↑go
}
`;
/** The same with a step that waits less. */
const OTHER = LINE.replace('2 -> 3 when ↑go', '2 -> 3 when not go');
/** Unstable situations are passed through under one profile and seen under the other. */
const QUICK = LINE.replace('step 2', 'step 2 { N N }').replace('2 -> 3 when ↑go', '2 -> 3 when go');
/** The product of counters has more pairs of states than a search visits in a moment. */
const MANY =
  'profile iec61131\n' +
  `input ${inputs(8)} : BOOL\noutput Q : LREAL\nvar x, y : LREAL\n` +
  'chart S {\n  initial step 0 { N x := x * 1.5 + BOOL_TO_INT(a0) N Q := x }\n  step 1\n  0 -> 1 when a7 and Q < 0.0\n}\n' +
  cells(7);

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'line.g7': LINE, 'other.g7': OTHER, 'iec.g7': `profile iec61131\n${LINE}`, 'renamed.g7': LINE.replace(/\b2\b/g, '9'), 'quick.g7': QUICK, 'many.g7': MANY, 'more.g7': LINE.replace('output M, N', 'output M'), 'wrong.g7': LINE.replace('when ↑go', 'when nothing') });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

async function panel(file: string, size?: { width: number; height: number }, prefs: object = {}): Promise<Opened> {
  const page = await openWith(b, site, file, { bottomOpen: true, bottom: 360, ...prefs }, size);
  await page.getByRole('tab', { name: /^Compare$|^Comparer$|^Comparar$/ }).click();
  return page;
}

/** Compares with what stands under this name in the list. */
async function compare(page: Page, other: string): Promise<void> {
  await page.getByRole('tabpanel').getByRole('combobox').first().selectOption(other);
  await page.getByRole('tabpanel').getByRole('button', { name: /^Compare$|^Comparer$|^Comparar$/ }).click();
}

const state = (page: Page) => page.getByRole('tabpanel').getByRole('status').first();

test('two files stand beside each other at their first difference, and play', async () => {
  const page = await panel('line.g7');
  await compare(page, 'other.g7');
  await page.getByText(/Different: in scan 3 output M has two values/).waitFor();
  const left = page.getByRole('region', { name: 'line.g7: chart and chronogram' });
  const right = page.getByRole('region', { name: 'other.g7: chart and chronogram' });
  await left.getByRole('group', { name: 'Chart G of line.g7' }).waitFor();
  await right.getByRole('img', { name: 'Chronogram of other.g7' }).waitFor();
  await page.locator('[data-apart]').nth(1).waitFor({ state: 'attached' });
  assert.equal(await page.locator('[data-apart]').count(), 2, 'the step that is active here alone is marked on each side');
  const table = page.getByRole('region', { name: 'Compare profiles' });
  assert.match(await table.getByRole('row').first().innerText(), /M\s+FALSE\s+TRUE/);
  await page.getByText('Scan 3 of 3').waitFor();
  await page.getByRole('button', { name: 'Back one scan' }).click();
  await page.getByText('Scan 2 of 3').waitFor();
  await until(async () => (await page.locator('[data-apart]').count()) === 0, 'before it both did the same');
  await page.getByRole('button', { name: 'Play both runs' }).click();
  await page.getByText('Scan 3 of 3').waitFor();
  await page.locator('[data-apart]').first().waitFor({ state: 'attached' });
  assert.deepEqual(await axe(page), []);
  await page.getByRole('button', { name: 'End', exact: true }).click();
  await page.getByText('Does it do the same').waitFor();
  assert.equal(await left.count(), 0);
  await done(page);
});

test('a chart under two profiles, before its last change, and read back from an export', async () => {
  const page = await panel('quick.g7');
  await compare(page, 'under iec61131');
  await page.getByText(/^Different: in scan \d/).waitFor();
  await page.getByRole('region', { name: 'iec61131: chart and chronogram' }).waitFor();
  await compare(page, 'before the last change');
  await page.getByText('There was no change yet.').waitFor();
  await page.locator('.sheet').focus();
  await page.keyboard.press('Insert');
  await drawn(page);
  await compare(page, 'before the last change');
  await page.getByText(/^(Equal|Different)/).waitFor();
  await page.getByRole('button', { name: 'Undo', exact: true }).click();
  await page.getByText('The text has changed since this comparison.').waitFor();
  await done(page);
  const exported = await panel('iec.g7');
  await compare(exported, 'PLCopen XML');
  await exported.getByText(/^Equal: the same outputs for every sequence of inputs/).waitFor();
  await done(exported);
});

test('situations are compared on request', async () => {
  const page = await panel('line.g7');
  await compare(page, 'renamed.g7');
  await page.getByText(/^Equal: the same outputs for every sequence of inputs/).waitFor();
  await page.getByRole('checkbox', { name: 'situations as well' }).check();
  await compare(page, 'renamed.g7');
  await page.getByText(/^Different: in scan 2 step .* is active in one of them only/).waitFor();
  await done(page);
});

test('a long comparison goes on beside the work, and stops', async () => {
  const page = await panel('many.g7');
  await compare(page, 'under unity');
  await page.getByText(/^Searching among/).waitFor();
  await page.getByRole('progressbar', { name: 'Search' }).waitFor();
  await page.getByRole('button', { name: 'One scan', exact: true }).click();
  await until(async () => (await page.getByRole('status').filter({ hasText: 'Active steps' }).innerText()).length > 0, 'the chart runs meanwhile');
  await page.getByRole('button', { name: 'Stop', exact: true }).click();
  await until(async () => (await state(page).innerText()).includes('Stopped.'), 'it says that it was stopped');
  assert.ok(await page.getByRole('tabpanel').getByRole('button', { name: 'Compare' }).isEnabled());
  await done(page);
});

test('charts that cannot be compared say why', async () => {
  const page = await panel('line.g7');
  await compare(page, 'more.g7');
  await page.getByText('These charts cannot be compared: the output N is in the first chart only.').waitFor();
  await compare(page, 'wrong.g7');
  await page.getByText('wrong.g7 has errors: mend them first.').waitFor();
  await done(page);
});

test('the panel in French and in the dark, and on a phone', async () => {
  const page = await panel('line.g7', undefined, { language: 'fr', theme: 'dark' });
  await compare(page, 'other.g7');
  await page.getByText('Différents : au cycle 3, la sortie').waitFor();
  await page.getByRole('region', { name: 'other.g7 : grafcet et chronogramme' }).waitFor();
  assert.deepEqual(await axe(page), []);
  await done(page);
  const phone = await panel('line.g7', { width: 390, height: 844 }, { leftOpen: false, rightOpen: false, language: 'pt' });
  await compare(phone, 'other.g7');
  const side = phone.getByRole('region', { name: 'other.g7: grafcet e cronograma' });
  await side.waitFor();
  const box = await side.boundingBox();
  assert.ok(box && box.x >= 0 && box.x + box.width <= 390, 'both sides are as wide as the window together');
  assert.deepEqual(await axe(phone), []);
  await done(phone);
});
