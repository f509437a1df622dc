// The panel *Why*: an answer goes back to the input that began it, in each language; its instants and symbols lead there; it is
// asked from the drawing, from the list of signals and by name, also of a run that a proof has found.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { axe, browser, done, drawn, item, openWith, playground, press, until, type Site } from './lib';
import { why as words } from '../src/lib/words/why';

const LINE = 'input go, stop : BOOL\noutput motor : BOOL\n\nchart G1 {\n  initial step 0\n  step 1 {\n    N motor\n  }\n  0 -> 1 when ↑go\n  1 -> 0 when stop\n}\n';
/** Both branches can be active, which a question forbids. */
const BOTH = 'input a, b : BOOL\noutput left, right : BOOL\n\nchart C {\n  initial step 1\n  step 2 { N left }\n  step 3 { N right }\n  1 -> 2 when a\n  1 -> 3 when b\n}\n\nprove never left and right\n';
/** Its test fails: nothing stops the motor. */
const FAILS = `${LINE}\ntest "it stops" {\n  set go := TRUE\n  wait until motor within 1s\n  set go := FALSE\n  wait 100ms\n  expect not motor\n}\n`;
const AT = { en: 0, fr: 1, pt: 2 } as const;

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  [site, b] = await Promise.all([playground({ 'line.g7': LINE, 'both.g7': BOTH, 'fails.g7': FAILS }), browser()]);
});

after(async () => {
  await b?.done();
  await site?.stop();
});

const panel = (page: Page) => page.locator('.why');
const said = async (page: Page) => (await panel(page).locator('.said').allTextContents()).map((text) => text.trim());

/** Runs the chart until `go` has started the motor. */
async function started(language: keyof typeof AT = 'en') {
  const page = await openWith(b, site, 'line.g7', { language, rightOpen: true });
  await drawn(page);
  await page.getByRole('tab').filter({ hasText: /^(Operate|Conduite|Operação)$/ }).first().click();
  await page.locator('.run .primary').first().click();
  const go = page.getByRole('switch', { name: 'go', exact: true });
  await go.click();
  await until(async () => (await page.getByRole('switch', { name: 'motor', exact: true }).getAttribute('aria-checked')) === 'true', 'the motor runs');
  await page.locator('.run .primary').first().click();
  return page;
}

test('an output goes back to the input, in each language', async () => {
  for (const [language, first, last] of [
    ['en', 'motor became TRUE', 'the input go became TRUE'],
    ['fr', 'motor a pris la valeur TRUE', 'l’entrée go a pris la valeur TRUE'],
    ['pt', 'motor tomou o valor TRUE', 'a entrada go tomou o valor TRUE'],
  ] as const) {
    const page = await started(language);
    await page.getByRole('button', { name: words['why.of'][AT[language]].replace('{name}', 'motor') }).click();
    await panel(page).locator('li').first().waitFor();
    const all = await said(page);
    assert.ok(all[0]?.startsWith(first), all.join('\n'));
    assert.ok(all.some((text) => text.startsWith(last)), all.join('\n'));
    assert.deepEqual(await axe(page), [], language);
    await done(page);
  }
});

test('a sentence leads to its symbol and to its instant', async () => {
  const page = await started();
  await page.getByRole('button', { name: 'Why is motor so?' }).click();
  await panel(page).getByRole('button', { name: /^step 1 became active/ }).click();
  await until(async () => (await item(page, 'G1/s/1').getAttribute('class'))?.includes('selected') === true || (await page.locator('.marks .selected').count()) > 0, 'the step is selected');
  const times = panel(page).locator('.at');
  const before = await times.first().textContent();
  await panel(page).locator('li', { hasText: 'step 0 became active' }).last().locator('.at').click();
  await until(async () => (await page.getByRole('switch', { name: 'motor', exact: true }).getAttribute('aria-checked')) === 'false', 'the run stands at its start');
  assert.equal(await times.first().textContent(), before, 'the answer stays');
  await done(page);
});

test('a transition that does not clear is asked from the drawing, a scan by its button', async () => {
  const page = await started();
  await press(page, 'G1/t/1');
  await page.keyboard.press('w');
  await panel(page).locator('li').first().waitFor();
  assert.ok((await said(page)).some((text) => text.includes('stop') && text.includes('FALSE')), (await said(page)).join('\n'));
  await page.getByRole('button', { name: words['why.scan'][0] }).click();
  await panel(page).locator('li').first().waitFor();
  const field = page.getByRole('combobox', { name: words['why.name'][0] });
  await field.fill('mtor');
  await field.press('Enter');
  await until(async () => (await panel(page).textContent())?.includes('mtor') === true, 'an unknown name is told');
  assert.ok((await panel(page).textContent())?.includes('motor'), 'and what is similar');
  await done(page);
});

test('a text that is no longer that of the run is told', async () => {
  const page = await started();
  await press(page, 'G1/t/1');
  await page.keyboard.press('Enter');
  await page.locator('.inplace > input').fill('not go');
  await page.locator('.inplace > input').press('Enter');
  await drawn(page);
  await page.getByRole('button', { name: 'Why is motor so?' }).click();
  await panel(page).getByText(words['why.changed'][0]).waitFor();
  await done(page);
});

test('the run that refutes a question is asked like any other', async () => {
  const page = await openWith(b, site, 'both.g7', { language: 'en', bottomOpen: true });
  await drawn(page);
  await page.getByRole('tab', { name: /^Prove/ }).click();
  await page.getByRole('button', { name: /^Play the run on the chart: .*left and right/ }).click();
  await page.getByRole('tab', { name: 'Operate' }).click();
  await page.getByRole('button', { name: 'Why is left so?' }).click();
  await panel(page).locator('li').first().waitFor();
  assert.ok((await said(page)).some((text) => text.startsWith('the input a became TRUE')), (await said(page)).join('\n'));
  await done(page);
});

test('a failed test says why, and is played to its failure', async () => {
  const page = await openWith(b, site, 'fails.g7', { language: 'en', bottomOpen: true, bottom: 320 });
  await drawn(page);
  await page.getByRole('tab', { name: 'Tests' }).click();
  await page.getByRole('button', { name: 'Run all tests' }).click();
  await page.getByText('1 of 1 failed').waitFor();
  await page.getByRole('button', { name: 'Why? it stops' }).click();
  const because = page.locator('.because .said');
  await because.first().waitFor();
  const all = (await because.allTextContents()).map((text) => text.trim());
  assert.ok(all[0]?.startsWith('motor became TRUE'), all.join('\n'));
  assert.ok(all.some((text) => text.startsWith('the input go became TRUE')), all.join('\n'));
  assert.deepEqual(await axe(page), []);
  await page.getByRole('button', { name: 'Play to this moment: it stops' }).click();
  await page.getByText('Run up to the failure: it stops').waitFor();
  await until(async () => (await page.getByRole('switch', { name: 'motor', exact: true }).getAttribute('aria-checked')) === 'true', 'the run stays where it fails');
  await done(page);
});
