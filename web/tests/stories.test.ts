// A story without the mouse: the bottle conveyor is drawn from nothing, its names are declared by
// the offered fixes, and it runs to five bottles.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import type { Locator, Page } from 'playwright-core';
import { browser, open, playground, textOf, until, type Site } from './lib';

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({});
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

const field = (page: Page) => page.locator('.inplace > input');

/** Types into the open field and applies the text. */
async function write(page: Page, text: string): Promise<void> {
  await field(page).waitFor();
  await page.keyboard.type(text);
  await page.keyboard.press('Enter');
  await field(page).waitFor({ state: 'detached' });
}

async function activate(control: Locator): Promise<void> {
  await control.focus();
  await control.press('Enter');
}

async function declare(page: Page, name: string, as: string, type = 'BOOL'): Promise<void> {
  const fix = page.getByRole('button', { name: `Fix: declare ${name} : ${type} as ${as}` });
  await activate(fix.first());
  await fix.first().waitFor({ state: 'detached' });
}

test('the bottle conveyor from nothing to five bottles, by keyboard alone', async () => {
  const page = await open(b, site);
  await activate(page.getByRole('button', { name: /Blank chart/ }));
  await page.locator('[data-part], .sheet [id^="i:"]').first().waitFor({ state: 'attached' });
  await page.locator('.sheet').focus();
  await page.keyboard.press('ArrowDown');

  await page.keyboard.press('Tab');
  await write(page, '↑start');
  await page.keyboard.press('a');
  await write(page, 'motor');
  await page.keyboard.press('a');
  await write(page, 'count := 0');
  await page.keyboard.press('a');
  await write(page, 'on ↑bottle: count := count + 1');
  await page.keyboard.press('j');
  await page.locator('dialog .list button').first().press('Enter');
  await write(page, 'count >= 5');

  await activate(page.getByRole('button', { name: 'Bottom' }));
  await activate(page.getByRole('tab', { name: /Problems/ }));
  await declare(page, 'start', 'an input');
  await declare(page, 'bottle', 'an input');
  await declare(page, 'motor', 'an output');
  // It counts, so it is no BOOL.
  await declare(page, 'count', 'a variable', 'INT');
  await page.getByText('No problems').waitFor();

  // The chart that other programs open in the tests of exports.
  assert.equal(await textOf(page), readFileSync(join(import.meta.dirname, 'drawn/conveyor.g7'), 'utf8'));

  const scan = page.getByRole('button', { name: 'One scan', exact: true });
  const signal = (name: string) => page.getByRole('switch', { name, exact: true });
  const value = (name: string) => signal(name).getAttribute('aria-checked');
  const turn = async (name: string) => {
    const was = await value(name);
    await signal(name).focus();
    await signal(name).press('Enter');
    await activate(scan);
    for (let n = 0; n < 50 && (await value(name)) === was; n++) await page.waitForTimeout(20);
  };
  await activate(scan);
  await signal('start').waitFor();
  assert.equal(await value('motor'), 'false');
  await turn('start');
  await turn('start');
  assert.equal(await value('motor'), 'true', 'the button starts the belt');
  for (let bottle = 1; bottle <= 5; bottle++) {
    assert.equal(await value('motor'), 'true', `the belt runs before bottle ${bottle}`);
    await turn('bottle');
    await turn('bottle');
  }
  await activate(scan);
  await until(async () => (await value('motor')) === 'false', 'five bottles stop it');
  assert.deepEqual(page.errors, []);
  await page.context().close();
});
