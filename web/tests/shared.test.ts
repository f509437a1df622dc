// One run held by the server and seen by two pages.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { browser, open, serve, until, type Site } from './lib';

const CHART = `input a : BOOL
output M : BOOL

chart G1 {
  initial step 0
  step 1 { N M }
  0 -> 1 when a
  1 -> 0 when not a
}
`;

let folder: string;
let site: Site;
let b: Awaited<ReturnType<typeof browser>>;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'g7-shared-'));
  writeFileSync(join(folder, 'shared.g7'), CHART);
  site = await serve(folder);
  b = await browser();
});

after(async () => {
  await b.done();
  await site.stop();
  rmSync(folder, { recursive: true, force: true });
});

const active = async (p: Page) => (await p.locator('.steps button.on').allInnerTexts()).join(' ');

async function joined(p: Page): Promise<void> {
  await p.getByRole('switch', { name: 'Shared run' }).click();
  await p.locator('.clock').waitFor();
}

test('what one page does the other one sees', async () => {
  const one = await open(b, site, 'shared.g7');
  await joined(one);
  const two = await open(b, site, 'shared.g7');
  await joined(two);

  await one.getByRole('button', { name: 'Run', exact: true }).click();
  await two.getByRole('button', { name: 'Pause', exact: true }).waitFor();
  await two.getByRole('switch', { name: 'a', exact: true }).click();
  await until(async () => (await active(one)) === '1', 'step 1 in the first page');
  await until(async () => (await active(two)) === '1', 'step 1 in the second page');

  await one.getByRole('button', { name: 'Force M' }).click();
  await two.locator('li.forced').waitFor();

  await two.getByRole('button', { name: 'Pause', exact: true }).click();
  await one.getByRole('button', { name: 'Run', exact: true }).waitFor();
  await until(async () => (await one.locator('.clock').innerText()) === (await two.locator('.clock').innerText()), 'both show one time');

  // A page that leaves does not affect the others.
  await two.context().close();
  await one.getByRole('button', { name: 'One scan', exact: true }).click();
  assert.equal(await active(one), '1');
  assert.deepEqual(one.errors, []);
  assert.equal(readFileSync(join(folder, 'shared.g7'), 'utf8'), CHART);
  await one.context().close();
});

test('breakpoints are those of all pages, and a page with another text is told so', async () => {
  const one = await open(b, site, 'shared.g7');
  await joined(one);
  await one.locator('[data-id="G1/s/1"]').first().click({ force: true });
  await one.keyboard.press('F9');
  const two = await open(b, site, 'shared.g7');
  await joined(two);
  // Breakpoints that were set before it joined, and changes while it watches.
  await two.getByRole('button', { name: 'Breakpoints 1' }).waitFor();
  await two.locator('[data-id="G1/s/0"]').first().click({ force: true });
  await two.keyboard.press('F9');
  await one.getByRole('button', { name: 'Breakpoints 2' }).waitFor();
  await two.context().close();

  const three = await open(b, site, 'shared.g7');
  await three.locator('[data-id="G1/s/0"]').first().click({ force: true });
  await three.keyboard.press('F2');
  await three.locator('.inplace > input').fill('Other');
  await three.keyboard.press('Enter');
  await three.locator('[data-id="G1/s/Other"]').waitFor({ state: 'attached' });
  await joined(three);
  await three.getByText('was begun from another text').waitFor();
  // Watching a run does not change it.
  await three.waitForTimeout(1500);
  assert.deepEqual(await three.locator('.steps button').allInnerTexts(), ['0', '1']);
  await three.getByRole('button', { name: 'Take over' }).click();
  await three.getByText('was begun from another text').waitFor({ state: 'detached' });
  await one.getByText('was begun from another text').waitFor();
  assert.deepEqual(one.errors, []);
  await three.context().close();
  await one.context().close();
});
