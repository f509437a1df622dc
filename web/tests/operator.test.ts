// The page of the operator: a machine is started, stopped, forced, breaks and comes back.
import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach, test } from 'node:test';
import type { Page } from 'playwright-core';
import { LYING, telephone, UPRIGHT } from './finger';
import { axe, box, browser, open, speak, until } from './lib';
import { Machine } from './machine';

let b: Awaited<ReturnType<typeof browser>>;
let machine: Machine;

before(async () => {
  b = await browser();
});

after(async () => {
  await b?.done();
});

beforeEach(async () => {
  machine = await Machine.start();
});

afterEach(async () => {
  await machine.done();
});

const DESK = { width: 1280, height: 800 };
const PHONE = { width: 390, height: 844 };

async function operator(size = DESK): Promise<Page & { errors: string[] }> {
  const page = await open(b, { url: machine.url, stop: async () => undefined }, undefined, size);
  await page.locator('.mode.stop, .mode.run, .mode.fault').waitFor();
  return page;
}

const button = (page: Page, name: string) => page.getByRole('button', { name, exact: true });
const card = (page: Page, name: string) => page.getByRole('region', { name, exact: true });
/** The row of a signal. */
const row = (page: Page, name: string) => page.locator('.values li').filter({ has: page.locator('b', { hasText: new RegExp(`^${name}$`) }) });
const shows = (page: Page, name: string, value: string) => row(page, name).locator('output', { hasText: new RegExp(`^${value}$`) }).waitFor();
const mode = (page: Page, name: 'stop' | 'run' | 'fault' | 'gone') => page.locator(`.mode.${name}`).waitFor();

async function enabled(page: Page): Promise<string[]> {
  const all = await page.getByRole('group', { name: 'Commands' }).getByRole('button').all();
  const names = await Promise.all(all.map(async (one) => ((await one.isEnabled()) ? (await one.innerText()).trim() : '')));
  return names.filter((name) => name !== '');
}

async function force(page: Page, name: string, value: string, time?: string): Promise<void> {
  await button(page, `Force ${name}`).click();
  const dialog = page.getByRole('dialog');
  if (value === 'TRUE' || value === 'FALSE') await dialog.getByRole('radio', { name: value }).check();
  else await dialog.getByLabel('Value').fill(value);
  if (time) await dialog.getByLabel('Ends after').selectOption({ label: time });
  await dialog.getByRole('button', { name: 'Force', exact: true }).click();
  await dialog.waitFor({ state: 'detached' });
}

test('a machine is started and stopped, and its values are seen', async () => {
  const page = await operator();
  await mode(page, 'stop');
  assert.match(await page.locator('.mode').innerText(), /A – stop procedures[\s\S]*STOP[\s\S]*Outputs are safe/);
  assert.deepEqual(await enabled(page), ['Start', 'Initial situation']);
  await card(page, 'Devices').getByText('answers', { exact: true }).waitFor();
  // In STOP outputs are safe, and the inputs are those of the machine.
  await row(page, 'lamp').getByText('safe value').waitFor();
  await shows(page, 'temperature', '20');
  await button(page, 'Start').click();
  await mode(page, 'run');
  assert.deepEqual(await enabled(page), ['Stop']);
  const steps = card(page, 'Active steps');
  await steps.getByText('ready').waitFor();
  await shows(page, 'lamp', 'TRUE');
  machine.press(true);
  await shows(page, 'start', 'TRUE');
  await steps.getByText('filling').waitFor();
  await shows(page, 'fill', 'TRUE');
  assert.equal(await row(page, 'fill').evaluate((li) => li.classList.contains('on')), true, 'its lamp is lit');
  // The drawing shows the same situation.
  await page.locator('.machine .live path.on[d^="M"]').waitFor({ state: 'attached' });
  await until(async () => /^\d/.test((await steps.locator('td').first().innerText()) ?? ''), 'the time of the step');
  await button(page, 'Stop').click();
  await mode(page, 'stop');
  await shows(page, 'fill', 'FALSE');
  assert.match(await card(page, 'Alarms and events').innerText(), /stopped[\s\S]*started/);
  machine.press(false);
  await button(page, 'Initial situation').click();
  await button(page, 'Start').click();
  await steps.getByText('ready').waitFor();
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('a force is seen until it is taken back or ends', async () => {
  const page = await operator();
  await button(page, 'Start').click();
  await mode(page, 'run');
  await shows(page, 'stir', 'FALSE');
  await force(page, 'stir', 'TRUE');
  await shows(page, 'stir', 'TRUE');
  const forced = card(page, 'Forced values');
  await forced.getByText(/9:\d\d min left|10:00 min left/).waitFor();
  await row(page, 'stir').getByText(/^forced · /).waitFor();
  // A second page sees it as well.
  const other = await operator(PHONE);
  await card(other, 'Forced values').getByText('stir').waitFor();
  await other.locator('summary').click();
  await force(other, 'batches', '41', '1 h');
  await shows(other, 'batches', '41');
  await forced.getByText(/59:\d\d min left|1:00 h left/).waitFor();
  await button(page, 'Take back the force on stir').click();
  await shows(page, 'stir', 'FALSE');
  await button(other, 'Take back the force on batches').click();
  await forced.getByText('Nothing is forced.').waitFor();
  assert.match(await card(page, 'Alarms and events').innerText(), /stir no longer forced/);
  // A value that cannot be forced is told in the dialog, which stays.
  await button(page, 'Force speed').click();
  const dialog = page.getByRole('dialog');
  await dialog.getByLabel('Value').fill('fast');
  await dialog.getByRole('button', { name: 'Force', exact: true }).click();
  await dialog.getByRole('alert').getByText(/fast|number|INT/).waitFor();
  await page.keyboard.press('Escape');
  await dialog.waitFor({ state: 'detached' });
  assert.deepEqual([...page.errors, ...other.errors], []);
  await other.context().close();
  await page.context().close();
});

test('a changed chart is taken over while the machine runs, and taken back', async () => {
  const page = await operator();
  await button(page, 'Start').click();
  await mode(page, 'run');
  machine.press(true);
  const steps = card(page, 'Active steps');
  await steps.getByText('stirring').waitFor();
  const bar = card(page, 'On-line change');
  assert.equal(await bar.count(), 0);
  // An error is told with its place, and the machine goes on.
  machine.edit((chart) => chart.replace('when high', 'when hi'));
  await bar.getByRole('button', { name: 'Take over…' }).click();
  const dialog = page.getByRole('dialog', { name: 'Take over the changed chart' });
  await dialog.getByRole('button', { name: 'Take over', exact: true }).click();
  await dialog.getByRole('alert').getByText(/mixer\.g7:\d+/).waitFor();
  await dialog.getByRole('button', { name: 'Cancel' }).click();
  // A step that is active is gone: the page asks first.
  machine.edit((chart) => chart.replace('step 2 "stirring"', 'step 22 "mixing"').replace('1 -> (2, 4)', '1 -> (22, 4)').replace('2 -> 3 when 30s/X2', '22 -> 3 when 30s/X22'));
  await bar.getByRole('button', { name: 'Take over…' }).click();
  await dialog.getByRole('button', { name: 'Take over', exact: true }).click();
  await dialog.getByText('step `stirring` is active and no longer exists').or(dialog.getByText('step `2` is active and no longer exists')).waitFor();
  assert.deepEqual(await axe(page), []);
  await dialog.getByRole('button', { name: 'Cancel' }).click();
  assert.match(await steps.innerText(), /stirring/);
  // Another time and another comment: the step goes on.
  machine.edit((chart) => chart.replace('"stirring"', '"stirring slowly"').replace('30s/X2', '600s/X2').replace('"stirrer, turns a minute"', '"turns of the stirrer"'));
  await bar.getByRole('button', { name: 'Take over…' }).click();
  await dialog.getByRole('button', { name: 'Take over', exact: true }).click();
  await dialog.waitFor({ state: 'hidden' });
  await steps.getByText('stirring slowly').waitFor();
  await row(page, 'speed').getByText('turns of the stirrer').waitFor();
  await shows(page, 'speed', '120');
  await page.locator('.machine .live path.on[d^="M"]').waitFor({ state: 'attached' });
  assert.match(await card(page, 'Alarms and events').innerText(), /goes on with the changed chart/);
  await bar.getByText('The chart was changed while it ran.').waitFor();
  await page.setViewportSize(PHONE);
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), true, 'it fits a phone');
  await page.setViewportSize(DESK);
  await bar.getByRole('button', { name: 'Take the change back' }).click();
  await page.getByRole('dialog', { name: 'Go back' }).getByRole('button', { name: 'Take the change back' }).click();
  await bar.getByText('The file of the chart has changed since.').waitFor();
  await steps.getByText('stirring', { exact: true }).waitFor();
  await mode(page, 'run');
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('a force that ends by itself is told', async () => {
  const page = await operator();
  await button(page, 'Start').click();
  await mode(page, 'run');
  // A second is shorter than the dialog offers: another client asks for it.
  await page.evaluate(async () => {
    const token = sessionStorage.getItem('g7-token') ?? '';
    const socket = new WebSocket(`ws://${location.host}/api/live?token=${token}`);
    await new Promise((done) => (socket.onopen = done));
    socket.send(JSON.stringify({ id: 1, call: { do: 'operator_force', name: 'heat', value: 'TRUE', seconds: 2 } }));
    await new Promise((done) => (socket.onmessage = done));
    socket.close();
  });
  await card(page, 'Forced values').getByText('heat').waitFor();
  await card(page, 'Forced values').getByText('Nothing is forced.').waitFor();
  await card(page, 'Alarms and events').getByText('heat no longer forced: its time is over').waitFor();
  await shows(page, 'heat', 'FALSE');
  await page.context().close();
});

test('a fault stands large with its reason until it is acknowledged', async () => {
  const page = await operator();
  await button(page, 'Start').click();
  await mode(page, 'run');
  await page.locator('summary').click();
  await force(page, 'divisor', '0', '1 min');
  machine.press(true);
  await mode(page, 'fault');
  const alert = page.locator('.mode').getByRole('alert');
  assert.match(await alert.innerText(), /FAULT[\s\S]*The chart failed: mixer\.g7:\d+:\d+: .*zero/);
  assert.deepEqual(await enabled(page), ['Acknowledge']);
  assert.deepEqual(await axe(page), [], 'in fault');
  await shows(page, 'fill', 'FALSE');
  const events = card(page, 'Alarms and events');
  await events.getByText('alarm · present').waitFor();
  await button(page, 'Acknowledge').click();
  await mode(page, 'stop');
  await events.getByText('alarm · gone').waitFor();
  await button(page, 'Acknowledge all').click();
  await page.locator('li.unseen').first().waitFor({ state: 'detached' });
  machine.press(false);
  await button(page, 'Take back the force on divisor').click();
  await button(page, 'Initial situation').click();
  await button(page, 'Start').click();
  await mode(page, 'run');
  await page.context().close();
});

test('a device that is gone makes its inputs bad, in words', async () => {
  const page = await operator();
  await shows(page, 'temperature', '20');
  await machine.unplug();
  await card(page, 'Devices').getByText('does not answer', { exact: true }).waitFor();
  await row(page, 'temperature').getByText('bad, last value').waitFor();
  await row(page, 'start').getByText('substituted').waitFor();
  await row(page, 'fill').getByText('bad', { exact: true }).waitFor();
  assert.deepEqual(await axe(page), [], 'without its device');
  await machine.plug();
  await card(page, 'Devices').getByText('answers', { exact: true }).waitFor();
  await row(page, 'temperature').getByText('bad, last value').waitFor({ state: 'detached' });
  await page.context().close();
});

test('a lost connection is seen at once, and no value looks present', async () => {
  const page = await operator();
  await button(page, 'Start').click();
  await mode(page, 'run');
  const gone = async () => {
    await mode(page, 'gone');
    assert.match(await page.locator('.mode').innerText(), /NO CONNECTION/);
    assert.deepEqual(await enabled(page), []);
    const rows = page.locator('.values section:not(:has(details)) li');
    assert.equal(await rows.getByText('no connection').count(), await rows.count());
    for (const name of ['Active steps', 'Drawing', 'Pace of the scans', 'Devices']) {
      await card(page, name).getByText('no connection').waitFor();
    }
    assert.equal(await page.getByRole('button', { name: /^Force / }).first().isEnabled(), false);
    assert.equal(await page.locator('.live path.on').getAttribute('d'), '', 'no step is drawn as active');
  };
  // The drawing comes from the server as well, and must be there before the server is silent.
  await page.locator('.live path.on[d^="M"]').waitFor({ state: 'attached' });
  // The network holds everything back: nothing is closed, nothing comes.
  machine.freeze(true);
  await gone();
  assert.deepEqual(await axe(page), [], 'without a connection');
  machine.freeze(false);
  await mode(page, 'run');
  // The controller ends.
  const ends = Date.now();
  await machine.end();
  await gone();
  assert.ok(Date.now() - ends < 15_000);
  await page.context().close();
});

test('the editor is one click away, and back', async () => {
  const page = await operator();
  assert.equal(await page.title(), 'STOP – mixer');
  const [editor] = await Promise.all([page.waitForEvent('popup'), page.getByRole('link', { name: 'Open the editor' }).click()]);
  await editor.waitForSelector('.sheet [data-id="Mixer/s/0"]', { state: 'attached' });
  await editor.getByRole('link', { name: 'Page of the operator' }).click();
  await editor.locator('.mode.stop').waitFor();
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

for (const [size, name] of [[DESK, 'a desktop'], [PHONE, 'a phone']] as const) {
  for (const theme of ['light', 'dark'] as const) {
    test(`axe finds nothing wrong on ${name}, ${theme}`, async () => {
      const page = await operator(size);
      await page.emulateMedia({ colorScheme: theme });
      const wide = await page.evaluate(() => document.documentElement.scrollWidth);
      assert.ok(wide <= size.width, `${wide} px wide`);
      assert.deepEqual(await axe(page), [], 'stopped');
      await button(page, 'Start').click();
      await mode(page, 'run');
      await force(page, 'stir', 'TRUE');
      await card(page, 'Forced values').getByText('stir').waitFor();
      await page.locator('summary').click();
      assert.deepEqual(await axe(page), [], 'running, with a force');
      await button(page, 'Force speed').click();
      assert.deepEqual(await axe(page), [], 'the dialog');
      await page.keyboard.press('Escape');
      // The mode and the commands stay in sight, and a finger can press them.
      await page.locator('.page').evaluate((p) => (p.scrollTop = p.scrollHeight));
      const at = await button(page, 'Stop').boundingBox();
      assert.ok(at && at.y >= 0 && at.y + at.height <= size.height && at.height >= 44, JSON.stringify(at));
      await page.context().close();
    });
  }
}

for (const [name, size] of [['upright', UPRIGHT], ['lying', LYING]] as const) {
  test(`a finger reaches every command of a machine, ${name}`, async () => {
    const hand = await telephone(b, { url: machine.url, stop: async () => undefined }, undefined, size);
    const { page } = hand;
    await mode(page, 'stop');
    await row(page, 'stir').waitFor();
    assert.deepEqual(await hand.unfit(), [], 'the page');
    // The mode stays in sight, so it must leave room for the values.
    const at = await box(page.locator('.mode'));
    assert.ok(at.height < size.height * 0.3, `the mode has ${at.height} of ${size.height} px`);
    await hand.press('Force stir');
    const now = await box(page.getByRole('dialog').getByRole('button', { name: 'Force', exact: true }));
    assert.ok(now.y + now.height <= size.height, `the last button ends at ${now.y + now.height} px`);
    assert.deepEqual(await hand.unfit(), [], 'the dialog of a force');
    await page.context().close();
  });
}

test('everything is reached and done by the keyboard, in three languages', async () => {
  const page = await operator();
  await button(page, 'Start').focus();
  await page.keyboard.press('Enter');
  await mode(page, 'run');
  await button(page, 'Force stir').focus();
  await page.keyboard.press('Enter');
  await page.getByRole('dialog').getByRole('radio', { name: 'FALSE' }).focus();
  await page.keyboard.press('ArrowUp');
  await page.keyboard.press('Enter');
  await card(page, 'Forced values').getByText('stir').waitFor();
  for (const [language, words] of [
    ['Français', ['F – procédures de fonctionnement', 'MARCHE', 'Acquitter', 'Valeurs forcées']],
    ['Português', ['F – procedimentos de funcionamento', 'MARCHA', 'Reconhecer', 'Valores forçados']],
  ] as const) {
    await speak(page, language);
    const text = await page.locator('.page').innerText();
    for (const word of words) assert.ok(text.includes(word), `${language}: ${word}`);
  }
  await page.context().close();
});
