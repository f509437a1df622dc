// Stories of the field of an action: its qualifier from a list with pictures, its time as a number with a unit, and an
// error that stands at the field.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { axe, browser, done, open, openWith, playground, press, textOf, until, type Site } from './lib';

const STEP = `output motor : BOOL
chart G1 {
  initial step 0 { N motor }
  step 1
  0 -> 1 when TRUE
  1 -> 0 when TRUE
}
`;

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'step.g7': STEP });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

const field = (page: Page) => page.locator('.inplace > input');
const list = (page: Page) => page.getByRole('listbox', { name: 'Qualifier' });

/** Waits until the text matches. */
async function says(page: Page, wanted: RegExp): Promise<void> {
  let text = '';
  for (let n = 0; n < 20 && !wanted.test(text); n++) text = await textOf(page);
  assert.match(text, wanted);
}

test('a qualifier and its time are chosen with the keys alone', async () => {
  const page = await open(b, site, 'step.g7');
  await press(page, 'G1/s/1');
  await page.keyboard.press('a');
  await field(page).fill('motor');
  await page.getByRole('button', { name: /^Qualifier/ }).waitFor();
  await field(page).press('Alt+ArrowDown');
  await list(page).locator('li').nth(11).waitFor();
  // Each of the eleven qualifiers has its name and its picture; the first row is for none.
  assert.deepEqual(await list(page).locator('li b').allInnerTexts(), ['–', 'N', 'S', 'R', 'L', 'D', 'P', 'P0', 'P1', 'SD', 'DS', 'SL']);
  assert.equal(await list(page).locator('li svg path.action').count(), 11);
  assert.deepEqual(await axe(page), []);
  await list(page).press('l');
  await list(page).press('Enter');
  const time = page.locator('.inplace').getByLabel('Time', { exact: true });
  await time.waitFor();
  assert.equal(await field(page).inputValue(), 'L 5s motor');
  await time.fill('3');
  await page.locator('.inplace').getByLabel('Unit of the time').selectOption('m');
  await page.waitForFunction(() => document.querySelector<HTMLInputElement>('.inplace > input')?.value === 'L 3m motor');
  await time.press('Enter');
  await field(page).waitFor({ state: 'detached' });
  await says(page, /step 1 \{ L 3m motor \}/);
  await done(page);
});

test('the field is seen as a whole, at the lower edge too', async () => {
  const page = await open(b, site, 'step.g7', { width: 1280, height: 560 });
  await press(page, 'G1/s/1');
  await page.keyboard.press('a');
  await field(page).fill('L motor if n > 3');
  await field(page).press('Enter');
  // The field grows by the error, and by what was meant.
  await page.getByRole('button', { name: /Write L 5s motor if n > 3/ }).waitFor();
  const inside = () =>
    page.evaluate(() => {
      const own = document.querySelector<HTMLElement>('.inplace');
      const round = own?.offsetParent?.getBoundingClientRect();
      const box = own?.getBoundingClientRect();
      return !!round && !!box && box.bottom <= round.bottom && box.top >= round.top;
    });
  await until(inside, 'the field is cut off');
  await page.keyboard.press('Escape');
  await page.keyboard.press('Escape');
  await done(page);
});

test('a qualifier is chosen with the mouse, and taken away', async () => {
  const page = await open(b, site, 'step.g7');
  await press(page, 'G1/a/0/0');
  await page.keyboard.press('Enter');
  await page.locator('.inplace').getByRole('button', { name: 'Qualifier: N' }).click();
  await list(page).getByRole('option', { name: /^P1/ }).click();
  await page.waitForFunction(() => document.querySelector<HTMLInputElement>('.inplace > input')?.value === 'P1 motor');
  await page.locator('.inplace').getByRole('button', { name: 'Qualifier: P1' }).click();
  await list(page).getByRole('option', { name: /^–/ }).click();
  await page.waitForFunction(() => document.querySelector<HTMLInputElement>('.inplace > input')?.value === 'motor');
  await page.keyboard.press('Escape');
  await done(page);
});

test('an error stands at the field, once, with the right form', async () => {
  const page = await open(b, site, 'step.g7');
  await press(page, 'G1/s/1');
  await page.keyboard.press('a');
  await field(page).fill('L motor');
  await field(page).press('Enter');
  const alert = page.locator('.inplace').getByRole('alert');
  await alert.getByText('needs a time').waitFor();
  await alert.getByRole('button', { name: 'Write L 5s motor' }).waitFor();
  assert.equal(await field(page).getAttribute('aria-invalid'), 'true');
  // Leaving the field does not try the same text again, and no notice comes.
  await page.locator('.tabs button, header button').first().focus();
  await page.locator('.sheet').focus();
  assert.equal(await page.locator('.notice').count(), 0);
  assert.equal(await page.getByRole('alert').count(), 1);
  assert.deepEqual(await axe(page), []);
  await field(page).focus();
  await page.keyboard.press('Enter');
  await page.waitForFunction(() => document.querySelector<HTMLInputElement>('.inplace > input')?.value === 'L 5s motor');
  await alert.waitFor({ state: 'detached' });
  await page.keyboard.press('Enter');
  await says(page, /step 1 \{ L 5s motor \}/);
  await done(page);
});

test('in the properties an error stands at its field too', async () => {
  const page = await openWith(b, site, 'step.g7', { view: 'chart', rightOpen: true });
  await press(page, 'G1/s/0');
  const panel = page.locator('.inspector');
  const action = panel.locator('fieldset input.code').first();
  await action.fill('motor L 3s');
  await action.press('Enter');
  await panel.getByRole('alert').getByRole('button', { name: 'Write L 3s motor' }).click();
  await says(page, /initial step 0 \{ L 3s motor \}/);
  assert.equal(await page.locator('.notice.error').count(), 0);
  await panel.getByLabel('Time', { exact: true }).fill('7');
  await panel.getByLabel('Time', { exact: true }).press('Enter');
  await says(page, /initial step 0 \{ L 7s motor \}/);
  assert.deepEqual(await axe(page), []);
  await done(page);
});
