// Wiring in the page: a device is added, a signal is wired, values are seen; and a panel is operated.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { LYING, telephone, UPRIGHT } from './finger';
import { axe, browser, open, until } from './lib';
import { Machine } from './machine';

let b: Awaited<ReturnType<typeof browser>>;

before(async () => {
  b = await browser();
});

after(async () => {
  await b?.done();
});

const DESK = { width: 1280, height: 800 };
const PHONE = { width: 390, height: 844 };

const dialog = (page: Page) => page.getByRole('dialog', { name: 'Wiring' });
const row = (page: Page, name: string) => dialog(page).locator('li').filter({ has: page.locator('.name b', { hasText: new RegExp(`^${name}$`) }) });

async function wiring(machine: Machine, size = DESK): Promise<Page & { errors: string[] }> {
  const page = await open(b, { url: machine.url, stop: async () => undefined }, undefined, size);
  // The bar of a telephone has it in its menu.
  if (size === PHONE) await page.getByRole('button', { name: 'More', exact: true }).click();
  await page.getByRole('button', { name: 'Wiring', exact: true }).click();
  await row(page, 'rack1').waitFor();
  return page;
}

test('a wiring is seen with its values, and changed line by line', async () => {
  const machine = await Machine.editor();
  try {
    const page = await wiring(machine);
    await row(page, 'rack1').getByText('answers').waitFor();
    await row(page, 'temperature').locator('output', { hasText: /^20(\.0)?$/ }).waitFor();
    assert.deepEqual(await axe(page), []);
    // A wire goes to another point; all else stays to the byte.
    const before = machine.io;
    await row(page, 'high').getByRole('button', { name: 'Change high' }).click();
    const form = page.getByRole('form', { name: 'Wire high' });
    await form.getByLabel('Address, from 0').fill('9');
    await form.getByLabel(/^bad/).selectOption({ label: 'a value of its own' });
    assert.deepEqual(await axe(page), []);
    await form.getByRole('button', { name: 'Write' }).click();
    await form.waitFor({ state: 'detached' });
    assert.equal(machine.io, before.replace('high = "rack1.discrete(1)"', 'high = { at = "rack1.discrete(9)", bad = false }'));
    // The device refuses an address that it does not have, and the others go on.
    await row(page, 'high').getByText(/exception 2/).waitFor();
    // The scale is computed from two points.
    await row(page, 'speed').getByRole('button', { name: 'Change speed' }).click();
    const speed = page.getByRole('form', { name: 'Wire speed' });
    await speed.getByText('Scale from two points').click();
    for (const [name, value] of [['Device, low', '0'], ['Device, high', '1000'], ['Chart, low', '0'], ['Chart, high', '500']] as const) await speed.getByLabel(name).fill(value);
    await speed.getByText('scale = 0.5, offset = 0').waitFor();
    await speed.getByRole('button', { name: 'Take these' }).click();
    await speed.getByRole('button', { name: 'Write' }).click();
    await speed.waitFor({ state: 'detached' });
    assert.match(machine.io, /speed = \{ at = "rack1\.holding\(0\)", .*scale = 0\.5/);
    // A wire is removed, and put where the chart has its address.
    await row(page, 'stir').getByRole('button', { name: 'Change stir' }).click();
    await page.getByRole('form', { name: 'Wire stir' }).getByRole('button', { name: 'Remove wire' }).click();
    await row(page, 'stir').getByText('not wired').waitFor();
    await row(page, 'stir').getByRole('button', { name: 'Wire stir' }).click();
    const stir = page.getByRole('form', { name: 'Wire stir' });
    await stir.getByRole('button', { name: /1$/ }).first().waitFor();
    assert.equal(await stir.getByLabel('Address, from 0').inputValue(), '1');
    await stir.getByRole('button', { name: 'Write' }).click();
    await row(page, 'stir').getByText('rack1.coil(1)').waitFor();
    // Somebody else writes the file: it is read again, and a wrong line has its place.
    machine.io = before.replace('coil(4)', 'discrete(4)');
    await row(page, 'lamp').getByText('outputs are coils or holding registers').waitFor();
    assert.deepEqual(page.errors, []);
    await page.context().close();
  } finally {
    await machine.done();
  }
});

test('a device is added and removed, also on a phone', async () => {
  const machine = await Machine.editor();
  try {
    const page = await wiring(machine, PHONE);
    const fits = () => page.evaluate(() => [...document.querySelectorAll('dialog .content')].every((e) => e.scrollWidth <= e.clientWidth));
    const before = machine.io;
    await dialog(page).getByRole('button', { name: 'Add a device' }).click();
    const form = page.getByRole('form', { name: 'New device' });
    await form.getByLabel('Name', { exact: true }).fill('desk');
    await form.getByLabel(/^Kind/).selectOption('panel');
    await form.getByLabel(/^release/).fill('2s');
    assert.equal(await fits(), true, 'the form fits a phone');
    assert.deepEqual(await axe(page), []);
    await form.getByRole('button', { name: 'Write' }).click();
    await row(page, 'desk').getByText('on the operator page').waitFor();
    assert.equal(machine.io, before.replace('[inputs]', '\n[devices.desk]\nkind = "panel"\nrelease = "2s"\n[inputs]'));
    await row(page, 'desk').getByRole('button', { name: 'Change desk' }).click();
    await page.getByRole('form', { name: 'Device desk' }).getByRole('button', { name: 'Remove device' }).click();
    await row(page, 'desk').waitFor({ state: 'detached' });
    assert.equal(machine.io, before);
    assert.equal(await fits(), true, 'the rows fit a phone');
    assert.deepEqual(page.errors, []);
    await page.context().close();
  } finally {
    await machine.done();
  }
});

for (const [name, size] of [['upright', UPRIGHT], ['lying', LYING]] as const) {
  test(`a finger wires a signal, ${name}`, async () => {
    const machine = await Machine.editor();
    try {
      const hand = await telephone(b, { url: machine.url, stop: async () => undefined }, undefined, size);
      const { page } = hand;
      await hand.press('More');
      await hand.press('Wiring');
      await row(page, 'rack1').waitFor();
      assert.deepEqual(await hand.unfit(), [], 'the rows');
      await row(page, 'speed').getByRole('button', { name: 'Change speed' }).tap();
      await page.getByRole('form', { name: 'Wire speed' }).waitFor();
      assert.deepEqual(await hand.unfit(), [], 'the form of a signal');
      await page.context().close();
    } finally {
      await machine.done();
    }
  });
}

test('a panel is operated, and a button is let go when its page dies', async () => {
  const machine = await Machine.desk();
  try {
    const page = await open(b, { url: machine.url, stop: async () => undefined }, undefined, DESK);
    const other = await open(b, { url: machine.url, stop: async () => undefined }, undefined, PHONE);
    const panel = (p: Page) => p.getByRole('region', { name: 'Panel desk' });
    const button = (p: Page) => panel(p).getByRole('button', { name: 'Start' });
    const pressed = (p: Page, on: boolean) => panel(p).locator(`button.push[aria-pressed="${on}"]`).waitFor();
    await panel(page).getByRole('radio', { name: /F1/ }).click();
    await panel(page).getByText('normal production').waitFor();
    await panel(other).getByRole('radio', { name: /F1/, checked: true }).waitFor();
    await button(page).hover();
    await page.mouse.down();
    await pressed(other, true);
    await page.getByRole('region', { name: 'Active steps' }).getByText('filling').waitFor();
    // Longer than the second after which a silent page lets go.
    await page.waitForTimeout(1500);
    await pressed(other, true);
    await page.close();
    await pressed(other, false);
    // The picture shows what is known, and says that the rest is not.
    const picture = other.getByRole('region', { name: 'Picture' });
    await picture.getByText('Dimmed: the machine has no sensor for it.').waitFor();
    const dimmed = () => other.evaluate(() => [...document.querySelectorAll('.picture')].flatMap((e) => [...(e.shadowRoot?.querySelectorAll<SVGElement>('.g7-unknown') ?? [])].map((e) => e.dataset.g7)));
    await until(async () => (await dimmed()).join() === 'bubbles', 'what is not measured');
    await panel(other).getByLabel('Amount, litres', { exact: true }).fill('20');
    await panel(other).getByRole('button', { name: 'Enter Amount, litres' }).click();
    await panel(other).locator('.lamp.red.on').waitFor();
    await panel(other).getByLabel('Amount, litres', { exact: true }).fill('200');
    await panel(other).getByRole('button', { name: 'Enter Amount, litres' }).click();
    await other.getByText('the number must be from 0 to 100').waitFor();
    const events = await other.getByRole('region', { name: 'Alarms and events' }).innerText();
    assert.match(events, /amount set to 20[\s\S]*start pressed[\s\S]*mode set to F1/);
    assert.equal(await other.evaluate(() => document.documentElement.scrollWidth <= innerWidth), true, 'it fits a phone');
    assert.deepEqual(await axe(other), []);
    assert.deepEqual(other.errors, []);
    await other.context().close();
  } finally {
    await machine.done();
  }
});
