// A gesture moves nothing that it does not concern: what is deleted leaves the rest in place, a command says what it joins, and
// links, views and steps go where they are dragged and nowhere else.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { axe, box, browser, core, done, drawn, item, openWith, playground, press, textOf, until, type Site } from './lib';

const numbers = (to: number) => Array.from({ length: to + 1 }, (_, n) => n);

/** Steps 0 to 9 behind one another, and back to 0. */
const CHAIN = `input a : BOOL
chart G {
  initial step 0
${numbers(9).slice(1).map((n) => `  step ${n}\n`).join('')}${numbers(9).map((n) => `  ${n} -> ${(n + 1) % 10} when a\n`).join('')}}
`;

const SMALL = `input a : BOOL
chart G {
  initial step 0
  step 1
  0 -> 1 when a
  1 -> 0 when not a
}
`;

const LINKS = `input a, b : BOOL
chart G {
  initial step 0
  step 1
  step 2
  0 -> 1 when a
  1 -> 2 when b
  2 -> 0 when a
}
`;

/** The whole chain is in view. */
const TALL = { width: 1280, height: 1700 };

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'chain.g7': CHAIN, 'small.g7': SMALL, 'links.g7': LINKS });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

/** Where the squares of steps are on the screen, in whole px. */
async function places(page: Page, steps: number[]): Promise<Record<number, string>> {
  await drawn(page);
  const at = async (n: number) => {
    const { x, y } = await box(item(page, `G/s/${n}`).locator('.g7-box').first());
    return [n, `${Math.round(x)} ${Math.round(y)}`] as const;
  };
  return Object.fromEntries(await Promise.all(steps.map(at)));
}

/** Presses the middle of a link between two symbols that follow one another downward. */
async function pressLink(page: Page, id: string): Promise<void> {
  await drawn(page);
  const line = await box(item(page, id));
  await page.mouse.click(line.x + line.width / 2, line.y + line.height / 2);
  await page.locator('.marks .selected-line').waitFor({ state: 'attached' });
}

async function says(page: Page, wanted: RegExp): Promise<void> {
  await until(async () => wanted.test(await textOf(page)), `the text matches ${wanted}`);
}

test('what a deleted transition leaves without a way in stays where it was', async () => {
  const page = await openWith(b, site, 'chain.g7', {}, TALL);
  const was = await places(page, numbers(9));
  await press(page, 'G/t/7');
  await page.keyboard.press('Delete');
  await item(page, 'G/t/9').waitFor({ state: 'detached' });
  assert.deepEqual(await places(page, numbers(9)), was);
  await page.keyboard.press('Control+z');
  await item(page, 'G/t/9').waitFor({ state: 'attached' });
  assert.deepEqual(await places(page, numbers(9)), was);
  await done(page);
});

test('the command says what it joins, in each language', async () => {
  const page = await openWith(b, site, 'chain.g7', {}, TALL);
  await press(page, 'G/s/5');
  await page.locator('.near').getByRole('button', { name: 'Delete and join 4 → 6', exact: true }).waitFor();
  await page.mouse.click(...(await core(page, 'G/s/5')), { button: 'right' });
  const rows = page.getByRole('menuitem', { name: /^Delete/ });
  assert.deepEqual(await rows.allInnerTexts().then((all) => all.map((row) => row.split('\n')[0])), ['Delete and join 4 → 6', 'Delete']);
  await rows.first().click();
  await item(page, 'G/s/5').waitFor({ state: 'detached' });
  await says(page, /4 -> 6 when a/);
  await page.locator('.sheet').focus();
  await press(page, 'G/t/2');
  await page.mouse.click(...(await core(page, 'G/t/2')), { button: 'right' });
  assert.equal(await page.getByRole('menuitem', { name: /^Delete/ }).count(), 1, 'nothing can be joined');
  await done(page);
  for (const [language, name] of [['fr', 'Supprimer et relier 4 → 6'], ['pt', 'Apagar e ligar 4 → 6']] as const) {
    const other = await openWith(b, site, 'chain.g7', { language }, TALL);
    await press(other, 'G/s/5');
    await other.locator('.near').getByRole('button', { name, exact: true }).waitFor();
    await done(other);
  }
});

test('a selected link shows its ends, and each can be taken elsewhere', async () => {
  const page = await openWith(b, site, 'links.g7', {});
  await pressLink(page, 'G/l/t:1>s:2');
  const to = page.getByRole('combobox', { name: 'To', exact: true });
  assert.equal(await to.inputValue(), 'G/s/2');
  assert.equal(await page.getByRole('combobox', { name: 'From', exact: true }).inputValue(), 'G/t/1');
  assert.deepEqual(await axe(page), []);
  await to.selectOption('G/s/1');
  await says(page, /1 -> 1 when b/);
  await page.locator('.sheet').focus();
  await page.keyboard.press('Control+z');
  await item(page, 'G/l/t:1>s:2').waitFor({ state: 'attached' });
  assert.equal(await textOf(page), LINKS, 'one step back');
  await done(page);
});

test('an end of a link is dragged to another step, and not to a transition', async () => {
  const page = await openWith(b, site, 'links.g7', {});
  await pressLink(page, 'G/l/s:0>t:0');
  const grip = await box(page.locator('.handle[data-end="from"]'));
  const drag = async (x: number, y: number) => {
    await page.mouse.move(grip.x + grip.width / 2, grip.y + grip.height / 2);
    await page.mouse.down();
    await page.mouse.move(x, y, { steps: 8 });
  };
  const [tx, ty] = await core(page, 'G/t/1');
  await drag(tx, ty);
  assert.equal(await page.locator('.marks .target').count(), 0);
  await page.mouse.up();
  assert.equal(await textOf(page), LINKS);
  const [x, y] = await core(page, 'G/s/2');
  await drag(x, y);
  await page.locator('.marks .target').waitFor({ state: 'attached' });
  await page.mouse.up();
  await says(page, /2 -> 1 when a/);
  await page.locator('.sheet').focus();
  await page.keyboard.press('Control+z');
  await item(page, 'G/l/s:0>t:0').waitFor({ state: 'attached' });
  assert.equal(await textOf(page), LINKS, 'one step back');
  await done(page);
});

test('a step that is dragged to the edge takes the view along', async () => {
  const page = await openWith(b, site, 'small.g7', {});
  const sheet = await box(page.locator('.sheet'));
  const [x, y] = await core(page, 'G/s/1');
  const still = async () => (await box(item(page, 'G/s/0').locator('.g7-box').first()).catch(() => null))?.y ?? -Infinity;
  const was = await still();
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x, sheet.y + sheet.height - 4, { steps: 8 });
  await until(async () => (await still()) < was - 300, 'the view goes down');
  await page.mouse.up();
  await drawn(page);
  const place = async () => Number(/step 1 at \([-\d.]+, ([-\d.]+)\)/.exec(await textOf(page))?.[1] ?? 0);
  await until(async () => (await place()) > 0, 'the step has its place');
  // It went as far as the pointer and the view together.
  assert.ok((await place()) * 10 > sheet.y + sheet.height - 4 - y + 300 - 1, `${await place()}`);
  await page.locator('.sheet').focus();
  await page.keyboard.press('Control+z');
  await until(async () => (await textOf(page)) === SMALL, 'one step back');
  await done(page);
});

test('a step that is dragged in a very small chart moves alone', async () => {
  const page = await openWith(b, site, 'small.g7', {});
  const was = await places(page, [0, 1]);
  const [x, y] = await core(page, 'G/s/1');
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 150, y + 40, { steps: 6 });
  await page.mouse.up();
  await says(page, /step 1 at/);
  await until(async () => (await places(page, [1]))[1] !== was[1], 'it is drawn at its new place');
  assert.equal((await places(page, [0]))[0], was[0]);
  await done(page);
});
