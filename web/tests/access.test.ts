// Accessibility: axe reports nothing, and everything can be reached by keyboard.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { axe, browser, open, playground, type Site } from './lib';

const SORTER = new URL('../../examples/bead-sorter/', import.meta.url);

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  const text = (name: string) => readFileSync(new URL(name, SORTER), 'utf8');
  site = await playground({
    'bead-sorter/chart.g7': text('chart.g7'),
    'bead-sorter/bead-sorter.svg': text('bead-sorter.svg'),
    'wrong.g7': 'chart G1 {\n initial step 0\n step 1\n 0 -> 1 when missing\n}\n',
  });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

for (const theme of ['light', 'dark'] as const) {
  test(`axe finds nothing wrong, ${theme}`, async () => {
    const page = await open(b, site, 'bead-sorter/chart.g7');
    await page.emulateMedia({ colorScheme: theme });
    assert.deepEqual(await axe(page), [], 'a chart');
    const step = await page.locator('.sheet [data-id="Sorter/s/Mode"]').boundingBox();
    assert.ok(step);
    await page.mouse.click(step.x + 10, step.y + 10);
    assert.deepEqual(await axe(page), [], 'a step selected');
    await page.keyboard.press('Shift+F10');
    assert.deepEqual(await axe(page), [], 'the menu');
    await page.keyboard.press('Escape');
    await page.keyboard.press('F2');
    await page.locator('.inplace > input').waitFor();
    assert.deepEqual(await axe(page), [], 'a field');
    await page.keyboard.press('Escape');
    await page.keyboard.press('?');
    await page.locator('dialog').waitFor();
    assert.deepEqual(await axe(page), [], 'the shortcuts');
    await page.keyboard.press('Escape');
    await page.context().close();
  });
}

test('a run with all of its panels is without violations', async () => {
  const page = await open(b, site, 'bead-sorter/chart.g7');
  await page.getByRole('button', { name: 'One scan', exact: true }).click();
  await page.getByRole('button', { name: 'Bottom' }).click();
  for (const name of ['Variables', 'Inputs and outputs', 'Tests', 'Chronogram']) {
    await page.getByRole('tab', { name }).click();
    assert.deepEqual(await axe(page), [], name);
  }
  // A selected symbol that is not visible must not be referred to.
  await page.locator('.sheet').focus();
  await page.keyboard.press('ArrowDown');
  for (let n = 0; n < 6; n++) await page.keyboard.press('-');
  await page.getByRole('button', { name: 'Drawing and text' }).click();
  assert.deepEqual(await axe(page), [], 'from afar');
  await page.context().close();
});

test('problems and both views are without violations', async () => {
  const page = await open(b, site, 'wrong.g7');
  await page.getByRole('button', { name: 'Bottom' }).click();
  await page.getByRole('button', { name: 'Drawing and text' }).click();
  assert.deepEqual(await axe(page), []);
  await page.context().close();
});

test('every control is reached by the Tab key', async () => {
  const page = await open(b, site, 'bead-sorter/chart.g7');
  const reached = new Set<string>();
  for (let n = 0; n < 160; n++) {
    await page.keyboard.press('Tab');
    const id = await page.evaluate(() => {
      const at = document.activeElement as HTMLElement | null;
      if (!at || at === document.body) return '';
      at.dataset.seen ??= String(Math.random());
      return at.dataset.seen;
    });
    if (id === '' || (reached.has(id) && reached.size > 3)) break;
    reached.add(id);
  }
  const missed = await page.evaluate(() => {
    const all = [...document.querySelectorAll<HTMLElement>('button, input, select, a[href], [tabindex="0"]')];
    const shown = all.filter((e) => e.checkVisibility() && !(e as HTMLButtonElement).disabled && e.tabIndex >= 0 && !e.dataset.seen);
    return shown.map((e) => e.getAttribute('aria-label') ?? e.textContent?.trim() ?? e.tagName);
  });
  assert.deepEqual(missed, []);
  await page.context().close();
});

for (const [width, height] of [[800, 1100], [768, 1024]] as const) {
  test(`the frame fits a tablet of ${width} px`, async () => {
    const page = await open(b, site, 'bead-sorter/chart.g7', { width, height });
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= width, `${wide} px wide`);
    const sheet = await page.locator('.sheet').boundingBox();
    assert.ok(sheet && sheet.width >= width - 100, `the drawing has ${sheet?.width} px`);
    // Every button of the bars is visible and can be pressed.
    for (const button of await page.locator('header button:visible, .bar[role=toolbar] button:visible').all()) {
      const at = await button.boundingBox();
      assert.ok(at && at.x >= 0 && at.x + at.width <= width, `${await button.getAttribute('aria-label')} at ${at?.x}`);
    }
    assert.deepEqual(await axe(page), []);
    await page.context().close();
  });
}

for (const theme of ['light', 'dark'] as const) {
  test(`the question before a changed file is closed is without violations, ${theme}`, async () => {
    const page = await open(b, site, 'wrong.g7');
    await page.emulateMedia({ colorScheme: theme });
    await page.locator('.sheet').focus();
    await page.keyboard.press('Insert');
    await page.getByRole('button', { name: 'Close wrong.g7' }).click();
    await page.getByRole('dialog').waitFor();
    assert.deepEqual(await axe(page), []);
    await page.keyboard.press('Escape');
    await page.getByRole('tab', { name: /wrong\.g7/ }).waitFor();
    await page.context().close();
  });
}
