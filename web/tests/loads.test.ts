// The files that the page fetches, and when: the second module of wasm only for what the first does not contain.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { browser, done, openWith, playground, press, until, type Opened, type Site } from './lib';

const LOOP = `input a : BOOL
output q : BOOL
chart G1 {
  initial step 1
  step 2 { N q }
  1 -> 2 when a
  2 -> 1 when not a
}

test "on" {
  set a := TRUE
  expect q
}
`;
const PUMP = '<?xml version="1.0"?><GCDocument name="Pump"><GCInitialStep id="1" name="S1" x="0" y="0"/></GCDocument>';
/** Longer than the page waits before it asks questions by itself, in ms. */
const PAUSE = 1_500;

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'loop.g7': LOOP, 'wrong.g7': LOOP.replace('when a', 'when c') });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

/** Opens the page; nothing of it was fetched before. */
function opened(file = 'loop.g7', prefs: object = {}): Promise<Opened> {
  site.fetched?.splice(0);
  return openWith(b, site, file, { bottomOpen: true, bottom: 300, ...prefs });
}

/** The modules that the page has fetched. */
const modules = () => [...new Set(site.fetched?.filter((name) => name.endsWith('.wasm')))];
/** The parts of the page with texts in other languages. */
const texts = () => site.fetched?.filter((name) => /\bsaid-/.test(name)).length;

const BOTH = ['g7.wasm', 'g7-whole.wasm'];

test('a chart is shown and run with the first module alone, and tested with the second', async () => {
  const page = await opened();
  await press(page, 'G1/s/2');
  await page.getByRole('button', { name: 'One scan', exact: true }).click();
  await page.getByRole('status').filter({ hasText: 'Active steps' }).waitFor();
  await page.getByRole('tab', { name: 'Tests' }).click();
  await page.waitForTimeout(PAUSE);
  assert.deepEqual(modules(), ['g7.wasm']);
  assert.equal(texts(), 0, 'an English page has its texts');
  await page.getByRole('button', { name: 'Run all tests' }).click();
  await page.getByText('All 1 passed').waitFor();
  assert.deepEqual(modules(), BOTH);
  await done(page);
});

test('an export, a file of another tool and a proof come from the second module', async () => {
  let page = await opened();
  await page.getByRole('button', { name: 'Export' }).click();
  await page.getByRole('combobox', { name: 'As' }).selectOption('c');
  await page.getByRole('region', { name: 'Preview of loop.c' }).waitFor();
  assert.deepEqual(modules(), BOTH);
  await done(page);

  page = await opened();
  const chooser = page.waitForEvent('filechooser');
  await page.getByRole('button', { name: 'Open', exact: true }).click();
  await (await chooser).setFiles({ name: 'pump.xml', mimeType: 'text/xml', buffer: Buffer.from(PUMP) });
  await page.locator('.sheet [data-id="Pump/s/S1"]').waitFor({ state: 'attached' });
  assert.deepEqual(modules(), BOTH);
  await done(page);

  page = await opened();
  await page.getByRole('tab', { name: 'Prove' }).click();
  await page.getByText('Everything is answered.').waitFor();
  assert.deepEqual(modules(), BOTH);
  await done(page);
});

test('after a change of the text the page asks questions by itself', async () => {
  const page = await opened();
  await press(page, 'G1/s/2');
  await page.locator('.sheet').focus();
  await page.keyboard.press('Tab');
  await until(() => Promise.resolve(modules().length === 2), 'the second module is fetched');
  await page.keyboard.press('Escape');
  await done(page);
});

test('problems are told in the language of the page, whose texts are fetched then', async () => {
  const page = await opened('wrong.g7', { language: 'fr' });
  await page.getByText('rien ne s’appelle').first().waitFor();
  assert.equal(texts(), 1);
  assert.deepEqual(modules(), ['g7.wasm']);
  await done(page);
});
