// The history on the page of the operator: what the machine did is seen, looked at closely, and taken along.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { axe, browser, open, speak, until } from './lib';
import { Machine } from './machine';

let b: Awaited<ReturnType<typeof browser>>;
let machine: Machine;

before(async () => {
  b = await browser();
  machine = await Machine.start();
});

after(async () => {
  await machine?.done();
  await b?.done();
});

const DESK = { width: 1280, height: 900 };
const PHONE = { width: 390, height: 844 };
const card = (page: Page) => page.getByRole('region', { name: 'History', exact: true });
const value = (page: Page, name: string) => card(page).locator('output', { has: page.locator(`xpath=self::*[@aria-label="${name}"]`) });
const lanes = (page: Page) => card(page).getByRole('group');

/** The number of different colours in the lanes: what is blank has two or three. */
const painted = (page: Page) =>
  card(page)
    .locator('canvas')
    .nth(1)
    .evaluate((canvas: HTMLCanvasElement) => {
      const data = canvas.getContext('2d')?.getImageData(0, 0, canvas.width, canvas.height).data ?? [];
      const found = new Set<number>();
      for (let i = 0; i < data.length; i += 4) found.add(((data[i] ?? 0) << 16) | ((data[i + 1] ?? 0) << 8) | (data[i + 2] ?? 0));
      return found.size;
    });

test('what the machine did is in its history', async () => {
  const page = await open(b, { url: machine.url, stop: async () => undefined }, undefined, DESK);
  await card(page).waitFor();
  await page.getByRole('button', { name: 'Start', exact: true }).click();
  await page.locator('.mode.run').waitFor();
  await until(async () => (await value(page, 'lamp').innerText()) === '1', 'the lamp is lit');
  machine.press(true);
  // The present is followed: the tank fills, and a step lasts.
  await until(async () => (await value(page, 'fill').innerText()) === '1', 'the valve is open');
  await until(async () => (await value(page, 'lamp').innerText()) === '0', 'the lamp is out');
  await until(async () => (await painted(page)) > 6, 'lanes are painted');
  // The cursor goes to the edges before: the lamp was lit then.
  await card(page).getByRole('button', { name: '10 min' }).click();
  await lanes(page).focus();
  await until(async () => {
    await page.keyboard.press('ArrowLeft');
    return (await value(page, 'lamp').innerText()) === '1' && (await value(page, 'fill').innerText()) === '0';
  }, 'the edge at which the valve opened lies behind');
  assert.match(await card(page).locator('.moment').innerText(), /\d\d:\d\d:\d\d/);
  await page.keyboard.press('+');
  await page.keyboard.press('PageUp');
  assert.equal(await card(page).getByRole('button', { name: 'Follow' }).getAttribute('aria-pressed'), 'false');
  await page.keyboard.press('End');
  assert.equal(await card(page).getByRole('button', { name: 'Follow' }).getAttribute('aria-pressed'), 'true');
  await page.keyboard.press('Escape');
  // Another signal is chosen, a number; it is there again when the page is loaded anew.
  await card(page).getByRole('button', { name: /^Signals/ }).click();
  await page.getByRole('dialog').getByRole('checkbox', { name: /^temperature/ }).check();
  await page.keyboard.press('Escape');
  await until(async () => /^\d/.test(await value(page, 'temperature').innerText()), 'a number');
  assert.deepEqual(await axe(page), []);
  const [download] = await Promise.all([
    page.waitForEvent('download'),
    (async () => {
      await card(page).getByRole('button', { name: 'Download what is shown' }).click();
      await page.getByRole('button', { name: 'Download as CSV' }).click();
    })(),
  ]);
  assert.equal(download.suggestedFilename(), 'mixer.csv');
  const parts: Buffer[] = [];
  for await (const part of await download.createReadStream()) parts.push(part as Buffer);
  const rows = Buffer.concat(parts).toString('utf8').split('\n');
  assert.equal(rows[0], 'time,record,signal,value');
  assert.ok(rows.some((row) => /^\d{4}-\d\d-\d\dT.*Z,[\d.]+,lamp,1$/.test(row)), rows.slice(0, 20).join('\n'));
  await page.reload();
  await card(page).waitFor();
  await until(async () => /^\d/.test(await value(page, 'temperature').innerText()), 'the choice is kept');
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('a record that has just begun has its signals as soon as there are any', async () => {
  const page = await open(b, { url: machine.url, stop: async () => undefined }, undefined, DESK);
  await card(page).waitFor();
  await page.evaluate(() => localStorage.clear());
  // The first two answers are those of a controller whose first scan is not recorded.
  const nothing = { title: 'Mixer', signals: [], from: 0, until: 0 };
  await page.route('**/api/history', (route) => route.fulfill({ json: nothing }), { times: 2 });
  await page.reload();
  await card(page).waitFor();
  await value(page, 'lamp').waitFor();
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('the history fits a phone, in three languages, light and dark', async () => {
  const page = await open(b, { url: machine.url, stop: async () => undefined }, undefined, PHONE);
  await card(page).waitFor();
  for (const theme of ['light', 'dark'] as const) {
    await page.emulateMedia({ colorScheme: theme });
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), true, 'it fits');
    assert.deepEqual(await axe(page), [], theme);
  }
  for (const [language, word] of [['Français', 'Historique'], ['Português', 'Histórico']] as const) {
    await speak(page, language);
    await page.getByRole('region', { name: word, exact: true }).waitFor();
  }
  await page.context().close();
});
