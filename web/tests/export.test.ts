// Stories of exports, and of imported charts of other tools.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { browser, open, playground, press, type Site } from './lib';

const LOOP = `input a : BOOL
output q : BOOL
chart G1 {
  initial step 1
  step 2 { N q }
  1 -> 2 when a
  2 -> 1 when not a
}
`;

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'loop.g7': LOOP, 'flat.g7': `profile iec61131\n${LOOP}` });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

/** Opens the export panel and chooses a form. */
async function chosen(page: Page, form: string): Promise<void> {
  await page.getByRole('button', { name: 'Export' }).click();
  await page.getByRole('combobox', { name: 'As' }).selectOption(form);
}

test('the code of the selected step is marked, and follows the chart', async () => {
  const page = await open(b, site, 'loop.g7');
  await chosen(page, 'c');
  const code = page.getByRole('region', { name: 'Preview of loop.c' });
  await code.waitFor();
  assert.equal(await code.locator('.marked').count(), 0);
  await press(page, 'G1/s/2');
  await code.locator('.marked').first().waitFor();
  for (const line of await code.locator('.marked').allInnerTexts()) assert.match(line, /STEP_2/);
  await page.locator('.sheet').focus();
  await page.keyboard.press('F2');
  await page.locator('.inplace > input').fill('Fill');
  await page.keyboard.press('Enter');
  await code.locator('.marked', { hasText: 'STEP_FILL' }).first().waitFor();
  // Code for a PLC is marked too, whatever its names for the steps are.
  await page.getByRole('combobox', { name: 'As' }).selectOption('st');
  const equations = page.getByRole('region', { name: 'Preview of loop.st' });
  await equations.locator('.marked', { hasText: /X_FILL/i }).first().waitFor();
  // A search for stability is a loop, which Ladder does not have; a profile with one pass can be
  // drawn.
  await page.getByRole('combobox', { name: 'As' }).selectOption('ladder');
  await page.getByRole('button', { name: /cannot be printed as Ladder/ }).waitFor();
  await page.getByRole('button', { name: 'flat.g7' }).first().click();
  await page.getByRole('img', { name: 'flat.svg' }).waitFor();
  await page.close();
});

test('a form is downloaded as it is shown, and what it does not carry is told', async () => {
  const page = await open(b, site, 'loop.g7');
  await chosen(page, 'mermaid');
  const shown = page.getByRole('region', { name: 'Preview of loop.mmd' });
  await shown.waitFor();
  const download = page.waitForEvent('download');
  await page.getByRole('button', { name: 'Download' }).click();
  const file = await (await download).path();
  assert.equal((await readFile(file, 'utf8')).trim(), (await shown.innerText()).trim());
  await chosen(page, 'svg');
  await page.getByRole('img', { name: 'loop.svg' }).waitFor();
  await page.close();
});

test('a chart of another tool that is opened becomes a .g7 file', async () => {
  const page = await open(b, site, 'loop.g7');
  const text = '<?xml version="1.0"?><GCDocument name="Pump"><GCInitialStep id="1" name="S1" x="0" y="0"/></GCDocument>';
  const chooser = page.waitForEvent('filechooser');
  await page.getByRole('button', { name: 'Open', exact: true }).click();
  await (await chooser).setFiles({ name: 'pump.xml', mimeType: 'text/xml', buffer: Buffer.from(text) });
  await page.locator('.sheet [data-id="Pump/s/S1"]').waitFor({ state: 'attached' });
  await page.getByRole('tab', { name: /pump\.g7/ }).waitFor();
  await page.close();
});
