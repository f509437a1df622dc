// Stories of drawing and editing, with keyboard and mouse.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { browser, drawn, open, playground, textOf, until, type Site } from './lib';

const SMALL = `input a, b, start : BOOL
output M : BOOL
chart G1 {
  initial step 0
}
`;

const LOOP = `input a, b : BOOL
output M, N : BOOL
chart G1 {
  initial step 0
  step 1 { N M }
  macro M2 = Inside
  0 -> 1 when a
  1 -> M2 when b
  M2 -> 0 when a and b
}
macrochart Inside {
  entry step E
  exit step S { N N }
  E -> S when a
}
`;

const ENCLOSING = `input a : BOOL
chart G1 {
  initial step 0
  enclosing step 1 {
    enclose G2
    enclose G3
  }
  0 -> 1 when a
  1 -> 0 when not a
}
chart G2 { step E * }
chart G3 { step E * }
`;

/** A long sequence with actions, and a second one beside it. */
const LONG = (() => {
  const row = (from: number) => Array.from({ length: 30 }, (_, n) => from + n);
  const steps = [...row(0), ...row(100)].map((n) => `  ${n % 100 === 0 ? 'initial ' : ''}step ${n}${n % 3 === 0 ? ' { N V }' : ''}\n`);
  const transitions = [...row(0), ...row(100)].map((n) => `  ${n} -> ${n % 100 === 29 ? n - 29 : n + 1} when a and not b\n`);
  return `input a, b : BOOL\noutput V : BOOL\nchart G1 {\n${steps.join('')}${transitions.join('')}}\n`;
})();

const WRONG = SMALL.replace('initial step 0', 'initial step 0\n  step 1\n  0 -> 1 when missing');

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'small.g7': SMALL, 'loop.g7': LOOP, 'wrong.g7': WRONG, 'enclosing.g7': ENCLOSING, 'long.g7': LONG });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

/** Waits until the text is `wanted`. */
async function becomes(page: Page, wanted: string): Promise<void> {
  let text = '';
  for (let n = 0; n < 20 && text !== wanted; n++) text = await textOf(page);
  assert.equal(text, wanted);
}

const item = (page: Page, id: string) => page.locator(`.sheet [data-id="${id}"]`);

async function middle(page: Page, id: string): Promise<[number, number]> {
  await drawn(page);
  // A changed drawing may be redrawn between two measurements.
  let box = await item(page, id).boundingBox();
  for (let n = 0; n < 20 && !box; n++) {
    await page.waitForTimeout(50);
    box = await item(page, id).boundingBox();
  }
  assert.ok(box, `${id} is drawn`);
  return [box.x + box.width / 2, box.y + box.height / 2];
}

async function click(page: Page, id: string, count = 1): Promise<void> {
  const [x, y] = await middle(page, id);
  await page.mouse.click(x, y, { clickCount: count });
}

const field = (page: Page) => page.locator('.inplace > input');
const words = (text: string) => text.replace(/\s+/g, ' ');

test('a chart of ten steps is drawn without the mouse', async () => {
  const page = await open(b, site, 'small.g7');
  await page.locator('.sheet').focus();
  await page.keyboard.press('ArrowDown');
  for (let n = 1; n < 10; n++) {
    await page.keyboard.press('Tab');
    await field(page).waitFor();
    await page.keyboard.type(n % 2 ? 'start' : 'a·/b');
    await page.keyboard.press('Enter');
    await item(page, `G1/s/${n}`).waitFor({ state: 'attached' });
    await field(page).waitFor({ state: 'detached' });
  }
  const text = words(await textOf(page));
  assert.match(text, /step 9 /);
  assert.match(text, /0 -> 1 when start/);
  assert.match(text, /7 -> 8 when a·\/b/);
  assert.match(text, /8 -> 9 when start/);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('names are completed in a field, and Tab goes from field to field', async () => {
  const page = await open(b, site, 'small.g7');
  await page.locator('.sheet').focus();
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('Tab');
  await field(page).waitFor();
  await page.keyboard.type('sta');
  await page.getByRole('option', { name: 'start' }).waitFor();
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('Enter');
  assert.equal(await field(page).inputValue(), 'start');
  await page.keyboard.press('Tab');
  await page.getByLabel('Edit the action').waitFor();
  await page.keyboard.type('M');
  await page.keyboard.press('Enter');
  await item(page, 'G1/a/1/0').waitFor({ state: 'attached' });
  const text = words(await textOf(page));
  assert.match(text, /step 1 \{ N M \}/);
  assert.match(text, /0 -> 1 when start/);
  await page.context().close();
});

test('everything that was done is undone, and done again', async () => {
  const page = await open(b, site, 'loop.g7');
  await click(page, 'G1/s/1');
  await page.keyboard.press('o');
  await field(page).waitFor();
  await page.keyboard.press('Escape');
  await page.keyboard.press('Delete');
  await click(page, 'G1/s/0');
  await page.keyboard.press('F2');
  await field(page).fill('Rest');
  await page.keyboard.press('Enter');
  await item(page, 'G1/s/Rest').waitFor({ state: 'attached' });
  const done = await textOf(page);
  assert.notEqual(done, LOOP);
  for (let n = 0; n < 6; n++) {
    await page.keyboard.press('Control+z');
    await drawn(page);
  }
  await becomes(page, LOOP);
  for (let n = 0; n < 6; n++) {
    await page.keyboard.press('Control+y');
    await drawn(page);
  }
  await becomes(page, done);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

/** For each symbol in the document: its box in the drawing, its texts and its name for screen readers. */
const shown = (page: Page): Promise<Record<string, string>> =>
  page.evaluate(async () => {
    // A new page may show the drawing before its font is loaded.
    await document.fonts.ready;
    const origin = document.querySelector('.plane')?.getBoundingClientRect();
    const symbols = [...document.querySelectorAll('.still [data-id]')];
    const found = Object.fromEntries(
      symbols.map((node) => {
        const { x, y, width, height } = node.getBoundingClientRect();
        const box = [x - (origin?.x ?? 0), y - (origin?.y ?? 0), width, height].map((n) => n.toFixed(1));
        return [node.getAttribute('data-id'), [...box, node.textContent, node.getAttribute('aria-label'), node.id].join(' ')];
      }),
    );
    return { ...found, 'number of symbols': `${symbols.length - Object.keys(found).length} twice` };
  });

test('after gestures every symbol stands where a new drawing of the text has it', async () => {
  const page = await open(b, site, 'long.g7', { width: 1280, height: 1600 });
  const same = async () => {
    await drawn(page);
    const text = await textOf(page);
    const other = await playground({ 'long.g7': text });
    const fresh = await open(b, other, 'long.g7', { width: 1280, height: 1600 });
    const [now, wanted] = [await shown(page), await shown(fresh)];
    const both = Object.keys(wanted).filter((id) => id in now);
    assert.ok(both.length > 80, `${both.length} symbols are in both`);
    for (const id of both) assert.equal(now[id], wanted[id], id);
    await fresh.context().close();
    await other.stop();
    return text;
  };
  // A branch moves what is beside it, the rest moves what is below it.
  for (const [id, key] of [['G1/s/3', 'Tab'], ['G1/s/5', 'Delete'], ['G1/s/103', 'Tab'], ['G1/s/1', 'Delete']] as const) {
    await click(page, id);
    await page.keyboard.press(key);
    await drawn(page);
    await page.keyboard.press('Escape');
    await same();
  }
  for (let n = 0; n < 4; n++) {
    await page.keyboard.press('Control+z');
    await same();
  }
  await becomes(page, LONG);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('a step is renamed everywhere', async () => {
  const page = await open(b, site, 'loop.g7');
  await click(page, 'G1/s/1');
  await page.keyboard.press('F2');
  await field(page).fill('Fill');
  await page.keyboard.press('Enter');
  await item(page, 'G1/s/Fill').waitFor({ state: 'attached' });
  const text = words(await textOf(page));
  assert.match(text, /step Fill \{ N M \}/);
  assert.match(text, /0 -> Fill when a/);
  assert.match(text, /Fill -> M2 when b/);
  await page.context().close();
});

test('an enclosing step opens the charts it encloses', async () => {
  const page = await open(b, site, 'enclosing.g7');
  await click(page, 'G1/a/1/1', 2);
  await item(page, 'G3/s/E').waitFor({ state: 'attached' });
  await page.locator('.sheet').focus();
  await page.keyboard.press('Backspace');
  await click(page, 'G1/s/1', 2);
  await item(page, 'G2/s/E').waitFor({ state: 'attached' });
  await page.context().close();
});

test('a macro-step opens in its own view, and the way back is told', async () => {
  const page = await open(b, site, 'loop.g7');
  await click(page, 'G1/s/M2', 2);
  await item(page, 'Inside/s/E').waitFor({ state: 'attached' });
  const way = page.getByRole('navigation', { name: 'Where this chart belongs' });
  assert.match((await way.innerText()).replace(/\s+/g, ' '), /G1 M2 Inside/);
  await page.locator('.sheet').focus();
  await page.keyboard.press('Backspace');
  await item(page, 'G1/s/M2').waitFor({ state: 'attached' });
  await page.context().close();
});

test('a step is moved with the mouse, and the layout is kept in the text', async () => {
  const page = await open(b, site, 'loop.g7');
  const [x, y] = await middle(page, 'G1/s/1');
  await page.mouse.move(x - 15, y);
  await page.mouse.down();
  await page.mouse.move(x + 105, y, { steps: 5 });
  await page.mouse.up();
  await page.waitForFunction(() => !document.querySelector('.marks .rubber'));
  assert.match(await textOf(page), /layout G1 \{[^}]*step 1 at \(/);
  await page.context().close();
});

test('a step dropped on a link goes into it', async () => {
  const page = await open(b, site, 'loop.g7');
  const tool = await page.getByRole('toolbar', { name: 'Palette' }).getByRole('button', { name: 'Step', exact: true }).boundingBox();
  assert.ok(tool);
  const [x, y] = await middle(page, 'G1/l/s:0>t:0');
  await page.mouse.move(tool.x + 15, tool.y + 15);
  await page.mouse.down();
  await page.mouse.move(x + 2, y, { steps: 6 });
  await page.locator('.marks .target').waitFor({ state: 'attached' });
  await page.mouse.up();
  await item(page, 'G1/t/3').waitFor({ state: 'attached' });
  const text = words(await textOf(page));
  assert.doesNotMatch(text, /[^\d]0 -> 1 when/);
  assert.match(text, /-> 1 when a/);
  await page.context().close();
});

test('a name that is taken is refused with a reason, and nothing is changed', async () => {
  const page = await open(b, site, 'loop.g7');
  await click(page, 'G1/s/0');
  await page.keyboard.press('F2');
  await field(page).fill('1');
  await page.keyboard.press('Enter');
  const refusal = page.locator('.inplace').getByRole('alert');
  await refusal.waitFor();
  assert.match(await refusal.innerText(), /1/);
  await page.keyboard.press('Escape');
  assert.equal(await textOf(page), LOOP);
  await page.context().close();
});

test('a problem is marked at its symbol and mended there', async () => {
  const page = await open(b, site, 'wrong.g7');
  await page.locator('.marks .badge').waitFor({ state: 'attached' });
  await click(page, 'G1/t/0');
  const note = page.locator('.note');
  await note.waitFor();
  assert.match(await note.innerText(), /missing/);
  await note.getByRole('button').first().click();
  await page.waitForFunction(() => !document.querySelector('.marks .badge:not(.warning)'));
  assert.match(await textOf(page), /missing : BOOL/);
  await page.context().close();
});

test('parts of a chart are copied into another file with new names', async () => {
  const page = await open(b, site, 'loop.g7');
  await click(page, 'G1/s/1');
  await page.keyboard.press('Control+c');
  await drawn(page);
  await page.keyboard.press('Control+v');
  await page.waitForFunction(() => document.querySelectorAll('.sheet [data-id^="G1/s/"]').length === 4);
  await page.getByRole('button', { name: 'small.g7' }).click();
  await item(page, 'G1/s/0').waitFor({ state: 'attached' });
  await page.locator('.sheet').focus();
  await page.keyboard.press('Control+v');
  await item(page, 'G1/s/1').waitFor({ state: 'attached' });
  assert.match(words(await textOf(page)), /step 1 \{ N M \}/);
  await page.context().close();
});

test('searching goes to the symbol', async () => {
  const page = await open(b, site, 'loop.g7');
  await page.locator('.sheet').focus();
  await page.keyboard.press('Control+f');
  await page.getByRole('combobox', { name: 'Search' }).fill('N N');
  await page.locator('dialog [role=option]').first().waitFor();
  await page.keyboard.press('Enter');
  await item(page, 'Inside/s/S').waitFor({ state: 'attached' });
  await page.locator('.marks .selected').first().waitFor();
  await page.context().close();
});

test('the view is moved, zoomed and fitted', async () => {
  const page = await open(b, site, 'loop.g7');
  const percent = async () => Number.parseInt(await page.locator('.zoom .percent').innerText(), 10);
  const was = await percent();
  await page.locator('.sheet').focus();
  await page.keyboard.press('+');
  assert.equal(await percent(), Math.round(was * 1.25));
  const [, before] = await middle(page, 'G1/s/0');
  await page.mouse.move(600, 400);
  await page.mouse.wheel(0, 100);
  await until(async () => Math.abs(before - (await middle(page, 'G1/s/0'))[1] - 100) < 3, 'the wheel moves the view');
  await page.keyboard.press('f');
  assert.ok((await middle(page, 'G1/s/0'))[1] > 60);
  await page.context().close();
});
