// Editing with the mouse alone, and from any focus: branches, the clipboard between charts,
// alignment, the overview, fixes by keyboard from the text.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { box, browser, core, item, open, playground, press, textOf, type Site } from './lib';

const CHART = `input a, b : BOOL
output M : BOOL

chart G1 {
  initial step 0
  step 1 { N M }
  0 -> 1 when a
  1 -> 0 when b
}

chart G2 {
  initial step 0
}
`;

// A name that is near another one may be a slip or a new one.
const SLIP = `input a : BOOL
output motor : BOOL
chart G1 {
  initial step 0
  step 1 { N moter }
  0 -> 1 when a
  1 -> 0 when not a
}
`;

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'chart.g7': CHART, 'slip.g7': SLIP });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

const symbols = (page: Page) => page.locator('.sheet [data-id]').evaluateAll((all) => all.map((e) => (e as HTMLElement).dataset.id ?? ''));

/** The places of the squares of some steps in the drawing. */
/** The corners of steps in the drawing. */
const corners = (page: Page, ids: string[]) =>
  Promise.all(
    ids.map((id) =>
      item(page, id)
        .locator('.g7-box')
        .first()
        .evaluate((e) => {
          // A symbol that was moved keeps its attributes, and its block is moved.
          const [drawing, box] = [e.closest<SVGGElement>('.still > g')?.getCTM(), (e as SVGRectElement).getCTM()];
          const { x, y } = new DOMPoint(Number(e.getAttribute('x')), Number(e.getAttribute('y'))).matrixTransform(drawing?.inverse().multiply(box ?? undefined));
          return [Math.round(x), Math.round(y)] as const;
        }),
    ),
  );

async function end(page: Page & { errors: string[] }): Promise<void> {
  assert.deepEqual(page.errors, []);
  await page.context().close();
}

test('simultaneous branches are opened and joined with the mouse', async () => {
  const page = await open(b, site, 'chart.g7');
  await page.getByRole('button', { name: 'G2' }).first().click();
  await item(page, 'G2/s/0').waitFor({ state: 'attached' });
  await press(page, 'G2/s/0');
  const near = (name: string) => page.locator('.near').getByRole('button', { name }).click();
  await near('Next transition and step');
  await item(page, 'G2/s/1').waitFor({ state: 'attached' });
  await page.keyboard.press('Escape');
  await press(page, 'G2/t/0');
  await near('Simultaneous branch (AND)');
  await item(page, 'G2/s/2').waitFor({ state: 'attached' });
  await page.keyboard.press('Escape');
  await press(page, 'G2/s/1');
  await page.keyboard.down('Shift');
  await page.mouse.click(...(await core(page, 'G2/s/2')));
  await page.keyboard.up('Shift');
  await near('Join as simultaneous');
  await item(page, 'G2/s/3').waitFor({ state: 'attached' });
  await page.keyboard.press('Escape');
  const text = await textOf(page);
  assert.match(text, /0 -> \(1, 2\) when/);
  assert.match(text, /\(1, 2\) -> 3 when/);
  await end(page);
});

test('what is cut in one chart is pasted into another, wherever the focus is', async () => {
  const page = await open(b, site, 'chart.g7');
  await press(page, 'G1/s/1');
  await page.keyboard.press('Control+x');
  await item(page, 'G1/s/1').waitFor({ state: 'detached' });
  await page.getByRole('button', { name: 'G2' }).first().click();
  await item(page, 'G2/s/0').waitFor({ state: 'attached' });
  await page.keyboard.press('Control+v');
  await item(page, 'G2/s/1').waitFor({ state: 'attached' });
  assert.ok((await symbols(page)).includes('G2/a/1/0'), 'its action came along');
  for (let n = 0; n < 2; n++) await page.keyboard.press('Control+z');
  await item(page, 'G2/s/1').waitFor({ state: 'detached' });
  assert.equal(await textOf(page), CHART);
  await end(page);
});

test('steps are lined up by the menu', async () => {
  const page = await open(b, site, 'chart.g7');
  const ids = ['G1/s/0', 'G1/s/1'];
  await press(page, 'G1/s/1');
  let [x, y] = await core(page, 'G1/s/1');
  // The view may still be moving.
  for (let still = 0; still < 3; ) {
    await page.waitForTimeout(50);
    const now = await core(page, 'G1/s/1');
    still = now[0] === x && now[1] === y ? still + 1 : 0;
    [x, y] = now;
  }
  await page.mouse.move(x, y);
  await page.mouse.down();
  // Alone, without its transitions.
  await page.keyboard.down('Alt');
  await page.mouse.move(x + 120, y + 30, { steps: 6 });
  await page.mouse.up();
  await page.keyboard.up('Alt');
  const aside = async () => {
    const [first, second] = await corners(page, ids);
    return (second?.[0] ?? 0) - (first?.[0] ?? 0);
  };
  // As the step is let go, it may be seen at its old place once more, until the new drawing is there.
  let seen = 0;
  for (let n = 0; n < 80 && seen < 3; n++) {
    seen = (await aside()) > 50 ? seen + 1 : 0;
    await page.waitForTimeout(50);
  }
  assert.equal(seen, 3, 'it was moved aside');
  const [, moved] = await corners(page, ids);
  await page.keyboard.down('Shift');
  await page.mouse.click(...(await core(page, 'G1/s/0')));
  await page.keyboard.up('Shift');
  await page.mouse.click(...(await core(page, 'G1/s/0')), { button: 'right' });
  await page.getByRole('menuitem', { name: 'Align left' }).click();
  for (let n = 0; n < 40 && (await aside()) > 0; n++) await page.waitForTimeout(50);
  const [one, other] = await corners(page, ids);
  assert.equal(one?.[0], other?.[0]);
  assert.equal(other?.[1], moved?.[1], 'not moved up or down');
  await end(page);
});

test('the overview moves the view, pressed and pulled', async () => {
  const page = await open(b, site, 'chart.g7');
  const nearer = page.getByRole('button', { name: 'Zoom in' });
  for (let n = 0; n < 5; n++) await nearer.click();
  const map = await box(page.locator('.map svg'));
  const top = async () => (await box(item(page, 'G1/s/0').locator('.g7-box').first()).catch(() => null))?.y ?? Number.NaN;
  await page.mouse.click(map.x + map.width / 2, map.y + 4);
  await page.waitForTimeout(150);
  const high = await top();
  await page.mouse.move(map.x + map.width / 2, map.y + 4);
  await page.mouse.down();
  await page.mouse.move(map.x + map.width / 2, map.y + map.height / 2, { steps: 5 });
  await page.mouse.up();
  await page.waitForTimeout(150);
  const low = await top();
  assert.ok(Number.isNaN(low) || high - low > 100, `${high}, then ${low}`);
  await end(page);
});

test('from the text, a fix is chosen by keyboard', async () => {
  const page = await open(b, site, 'slip.g7');
  await page.getByRole('button', { name: 'Drawing and text' }).click();
  await page.locator('.cm-lintRange-error').waitFor();
  await page.locator('.cm-content').focus();
  await page.keyboard.press('F8');
  await page.keyboard.press('Control+.');
  // There are several ways, so the list offers them.
  await page.waitForFunction(() => document.activeElement?.classList.contains('problem'));
  await page.keyboard.press('Tab');
  await page.keyboard.press('Tab');
  await page.keyboard.press('Enter');
  await page.locator('.cm-lintRange-error').waitFor({ state: 'detached' });
  assert.match(await textOf(page), /output moter : BOOL/);
  await end(page);
});
