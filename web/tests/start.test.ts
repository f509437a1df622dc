// Stories of starting: the gallery, templates, the tour, own files; and the tables and tests below
// the drawing.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { axe, browser, open, playground, textOf, until, type Site } from './lib';

const example = (path: string) => readFileSync(new URL(`../../examples/${path}`, import.meta.url), 'utf8');
const CONVEYOR = 'bottle-conveyor/chart.g7';

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ [CONVEYOR]: example(CONVEYOR), 'structure/gemma.g7': example('structure/gemma.g7') });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

/** Presses the middle of a symbol's shape. */
async function press(page: Page, id: string, clickCount = 1): Promise<void> {
  const symbol = page.locator(`.sheet [data-id="${id}"]`).first();
  let box = await symbol.boundingBox();
  // The view may still be moving.
  for (let still = 0; still < 3; ) {
    await page.waitForTimeout(100);
    const now = await symbol.boundingBox();
    still = JSON.stringify(now) === JSON.stringify(box) ? still + 1 : 0;
    box = now;
  }
  assert.ok(box, id);
  await page.mouse.click(box.x + Math.min(20, box.width / 2), box.y + box.height / 2, { clickCount });
}

async function below(page: Page, tab: string): Promise<void> {
  if ((await page.getByRole('tab', { name: tab }).count()) === 0) await page.getByRole('button', { name: 'Bottom' }).click();
  await page.getByRole('tab', { name: tab }).click();
}

test('the gallery draws the examples and opens them', async () => {
  const page = await open(b, site);
  const card = page.getByRole('button', { name: /five bottles stop it/ });
  // A card is drawn when it comes into sight, and the exercises stand before the examples.
  const toExamples = () => page.locator('.groups .card').first().scrollIntoViewIfNeeded();
  await page.getByRole('heading', { name: 'Exercises' }).waitFor();
  await toExamples();
  await card.waitFor();
  assert.match(await card.innerText(), /2 steps · 6 tests · plant/);
  assert.ok((await card.locator('svg .g7-box').count()) >= 2);
  await page.getByRole('searchbox').fill('gemma');
  assert.equal(await card.count(), 0);
  await page.getByRole('searchbox').fill('');
  await toExamples();
  await card.click();
  await page.waitForSelector('.sheet [data-id="Conveyor/s/1"]', { state: 'attached' });
  await page.getByRole('button', { name: 'Gallery' }).click();
  await page.getByRole('heading', { name: 'Open lately' }).waitFor();
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('every template begins without a problem', async () => {
  const page = await open(b, site);
  for (const name of ['Blank chart', 'Bottle conveyor', 'Choice', 'Side by side', 'Macro-step', 'Enclosing step']) {
    await page.locator('.template', { hasText: name }).click();
    await page.waitForSelector('.sheet [data-id]', { state: 'attached' });
    await below(page, 'Problems');
    await page.getByText('No problems').waitFor();
    await page.getByRole('button', { name: 'Gallery' }).click();
  }
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('the guided first chart goes on by itself, and ends with a lamp that is lit', async () => {
  const page = await open(b, site);
  await page.getByRole('button', { name: 'First chart in two minutes' }).click();
  const lesson = (title: string) => page.getByRole('heading', { name: title }).waitFor({ timeout: 10_000 });
  await lesson('This is a step');
  await page.waitForSelector('.sheet [data-id="G1/s/0"]', { state: 'attached' });
  await press(page, 'G1/s/0');
  await lesson('Go on to a second step');
  await page.keyboard.press('Tab');
  await lesson('When may it go on?');
  await page.locator('.inplace > input').fill('↑start');
  await page.keyboard.press('Enter');
  await lesson('What is start?');
  await page.getByRole('button', { name: 'Fix: declare start : BOOL as an input' }).click();
  await lesson('Let it do something');
  await press(page, 'G1/s/1');
  await page.keyboard.press('a');
  await page.locator('.inplace > input').fill('N lamp');
  await page.keyboard.press('Enter');
  await lesson('The lamp is an output');
  await page.getByRole('button', { name: 'Fix: declare lamp : BOOL as an output' }).click();
  await lesson('Back to the beginning');
  await press(page, 'G1/s/1');
  await page.keyboard.press('j');
  await page.getByRole('dialog').getByRole('button', { name: 'Initial step 0' }).click();
  await lesson('Three seconds');
  if (!(await page.locator('.inplace > input').isVisible())) await press(page, 'G1/t/1', 2);
  await page.locator('.inplace > input').fill('3s/X1');
  await page.keyboard.press('Enter');
  await lesson('Run it');
  await page.getByRole('button', { name: 'Run', exact: true }).click();
  await lesson('Press the button');
  await page.getByRole('switch', { name: /start/ }).first().click();
  await lesson('That is a GRAFCET');
  assert.match(await textOf(page), /input start : BOOL[^]*output lamp : BOOL[^]*0 -> 1 when ↑start\n {2}1 -> 0 when 3s\/X1/);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('a file from elsewhere is dropped in', async () => {
  const page = await open(b, site);
  await page.getByRole('heading', { level: 1 }).waitFor();
  const data = await page.evaluateHandle(() => {
    const transfer = new DataTransfer();
    transfer.items.add(new File(['chart Mine {\n  initial step 7\n}\n'], 'mine.g7'));
    return transfer;
  });
  await page.dispatchEvent('main', 'drop', { dataTransfer: data });
  await page.waitForSelector('.sheet [data-id="Mine/s/7"]', { state: 'attached' });
  await page.getByRole('button', { name: 'Gallery' }).click();
  const [chooser] = await Promise.all([page.waitForEvent('filechooser'), page.getByRole('button', { name: 'Open a file' }).click()]);
  await chooser.setFiles({ name: 'other.xml', mimeType: 'text/xml', buffer: Buffer.from('<?xml version="1.0"?><project/>') });
  await page.getByText('other.xml is neither').waitFor();
  assert.equal(await page.getByRole('tab', { name: 'other.xml' }).count(), 0);
  await page.context().close();
});

test('variables are added, renamed everywhere, changed, taken away', async () => {
  const page = await open(b, site, CONVEYOR);
  await below(page, 'Variables');
  await page.getByLabel('Name: motor').fill('belt');
  await page.keyboard.press('Enter');
  await page.getByLabel('Name: belt').waitFor();
  await page.getByLabel('Initial value: count').fill('3');
  await page.keyboard.press('Enter');
  await page.getByRole('button', { name: 'Add', exact: true }).click();
  await page.getByLabel('Name: v1').waitFor();
  await page.getByLabel('Type: v1').fill('TIME');
  await page.keyboard.press('Enter');
  await page.getByRole('button', { name: 'Delete: bottle', exact: true }).waitFor();
  await until(async () => /var v1 : TIME/.test(await textOf(page)), 'the type is in the text');
  const text = await textOf(page);
  assert.match(text, /output belt : BOOL at %Q0\.0 "belt"/);
  assert.match(text, /expect belt, X1/);
  assert.match(text, /var count : INT := 3 retain/);
  assert.match(text, /var v1 : TIME/);
  await page.getByRole('button', { name: 'Delete: v1', exact: true }).click();
  await page.getByLabel('Name: v1').waitFor({ state: 'detached' });
  await below(page, 'Inputs and outputs');
  await page.getByLabel('Address: bottle').fill('%I0.0');
  await page.keyboard.press('Enter');
  await page.locator('td.clash').first().waitFor();
  assert.equal(await page.locator('td.clash').count(), 2);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('tests are run, and what fails is shown at its line', async () => {
  const page = await open(b, site, CONVEYOR);
  await below(page, 'Tests');
  await page.getByRole('button', { name: 'Run all tests' }).click();
  await page.getByText('All 6 passed').waitFor();
  await page.getByText('Steps 2/2').waitFor();
  await page.getByRole('button', { name: 'Show all' }).click();
  await press(page, 'Conveyor/t/1', 2);
  await page.locator('.inplace > input').fill('count >= 6');
  await page.keyboard.press('Enter');
  await page.getByText('The text has changed since.').waitFor();
  await page.getByRole('button', { name: 'Run this test: stops after five bottles' }).click();
  await page.getByText('1 of 1 failed').waitFor();
  await page.getByRole('button', { name: 'expected: not motor' }).click();
  await page.locator('.cm-picked', { hasText: 'expect not motor, X0' }).waitFor();
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

for (const theme of ['light', 'dark'] as const) {
  test(`axe finds nothing wrong in text, tables and gallery, ${theme}`, async () => {
    const page = await open(b, site, CONVEYOR);
    await page.emulateMedia({ colorScheme: theme });
    await page.getByRole('button', { name: 'Drawing and text' }).click();
    await page.waitForSelector('.tok-keyword');
    for (const tab of ['Variables', 'Inputs and outputs', 'Tests']) {
      await below(page, tab);
      if (tab === 'Tests') {
        await page.getByRole('button', { name: 'Run all tests' }).click();
        await page.getByText('All 6 passed').waitFor();
      }
      assert.deepEqual(await axe(page), [], tab);
    }
    await page.locator('.cm-content').click();
    await page.keyboard.press('Control+f');
    await page.locator('.cm-search').waitFor();
    assert.deepEqual(await axe(page), [], 'search in the text');
    await page.getByRole('button', { name: 'Gallery' }).click();
    await page.locator('.card svg').first().waitFor();
    assert.deepEqual(await axe(page), [], 'the gallery');
    await page.getByRole('button', { name: 'First chart in two minutes' }).click();
    await page.getByRole('heading', { name: 'This is a step' }).waitFor();
    assert.deepEqual(await axe(page), [], 'the guide');
    await page.context().close();
  });
}
