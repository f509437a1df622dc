// Stories of printing: the preview shows the sheets, and what the browser prints has as many pages, of that size.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { browser, open, playground, type Site } from './lib';

/** A chart of so many steps in a row, which one sheet does not hold, and a test that fails. */
const long = (steps: number): string => {
  const lines = Array.from({ length: steps }, (_, n) => `  step ${n + 1} "waits"\n  ${n} -> ${n + 1} when a`);
  return `input a : BOOL "the button"\noutput q : BOOL\nchart Long {\n  initial step 0\n${lines.join('\n')}\n  ${steps} -> 0 when a\n}\ntest "never" {\n  expect q\n}\n`;
};

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'long.g7': long(60) });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

/** The number of sheets that the preview tells. */
async function told(page: Page): Promise<number> {
  const status = page.getByRole('dialog').getByRole('status').filter({ hasText: /sheet 1 of \d+/ });
  await status.waitFor();
  return Number(/of (\d+)/.exec(await status.innerText())?.[1]);
}

/** The pages of a PDF, and their sizes in points. */
function pages(pdf: Buffer): string[] {
  return [...pdf.toString('latin1').matchAll(/\/MediaBox\s*\[\s*0 0 ([\d.]+) ([\d.]+)\s*\]/g)].map((m) => `${Math.round(Number(m[1]))}×${Math.round(Number(m[2]))}`);
}

test('the preview shows the sheets that the browser prints', async () => {
  const page = await open(b, site, 'long.g7');
  // Wherever the focus is.
  await page.getByRole('button', { name: 'New chart' }).focus();
  await page.keyboard.press('Control+p');
  const dialog = page.getByRole('dialog', { name: 'Print' });
  const portrait = await told(page);
  assert.ok(portrait > 1, `${portrait} sheets`);
  await page.getByRole('button', { name: `Print (${portrait})` }).waitFor();
  assert.deepEqual(pages(await page.pdf({ preferCSSPageSize: true })), Array(portrait).fill('595×842'));
  await dialog.getByLabel('Paper').selectOption('a3-landscape');
  await dialog.getByRole('img', { name: /sheet 1 of/ }).and(dialog.locator('[style*="420 / 297"]')).waitFor();
  const landscape = await told(page);
  assert.deepEqual(pages(await page.pdf({ preferCSSPageSize: true })), Array(landscape).fill('1191×842'));
  // Without the preview the browser prints the chart in view, as it is.
  await page.keyboard.press('Escape');
  await dialog.waitFor({ state: 'detached' });
  assert.equal(await page.locator('.print-sheets').count(), 0);
});

test('the keys turn the sheets, and the title block says what the fields say', async () => {
  const page = await open(b, site, 'long.g7');
  await page.locator('.sheet').focus();
  await page.keyboard.press('Control+p');
  const dialog = page.getByRole('dialog', { name: 'Print' });
  await told(page);
  await page.keyboard.press('PageDown');
  await dialog.getByRole('status').filter({ hasText: /sheet 2 of/ }).waitFor();
  await page.keyboard.press('PageUp');
  await dialog.getByRole('status').filter({ hasText: /sheet 1 of/ }).waitFor();
  await dialog.getByLabel('Author').fill('A. Martin');
  await dialog.locator('.paper').getByText('A. Martin').waitFor();
});

test('the dossier has the tests that the page runs', async () => {
  const page = await open(b, site, 'long.g7');
  await page.locator('.sheet').focus();
  await page.keyboard.press('Control+p');
  const dialog = page.getByRole('dialog', { name: 'Print' });
  await told(page);
  await dialog.getByRole('combobox', { name: 'Print' }).selectOption('dossier');
  await dialog.locator('.paper').getByText('0 / 1').first().waitFor();
  const many = await told(page);
  assert.equal(pages(await page.pdf({ preferCSSPageSize: true })).length, many);
});
