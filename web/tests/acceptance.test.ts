// Cases found when every sentence about editing and accessibility was tried by hand.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { axe, browser, drawn, open, playground, textOf, until, type Site } from './lib';

const LINE = `input a, b : BOOL
chart G1 {
  initial step 0
  step 1
  step 2
  0 -> 1 when a
  1 -> 2 when b
  2 -> 0 when a and b
}
`;

const OTHER = `input c : BOOL
output M : BOOL
chart G2 {
  initial step 0
  step 1 { N M }
  0 -> 1 when c
  1 -> 0 when not c
}
`;

/** Every name exists twice. */
const TWICE = `input a, a : BOOL
chart G1 {
  initial step 0
  step 1 { N a; N a }
  step 1 { N a; N a }
  0 -> 1 when a
  1 -> 0 when a
}
chart G1 {
  initial step 0
}
test "t" { }
test "t" { }
`;

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'line.g7': LINE, 'other.g7': OTHER, 'twice.g7': TWICE });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

const item = (page: Page, id: string) => page.locator(`.sheet [data-id="${id}"]`);

/** A place on the symbol itself, not on its texts. */
async function place(page: Page, id: string): Promise<[number, number]> {
  await drawn(page);
  const box = await item(page, id).boundingBox();
  assert.ok(box, `${id} is drawn`);
  return [box.x + 10, box.y + 10];
}

async function click(page: Page, id: string): Promise<void> {
  await page.mouse.click(...(await place(page, id)));
}

async function drag(page: Page, from: [number, number], to: [number, number]): Promise<void> {
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move(...to, { steps: 6 });
  await page.mouse.up();
}

const words = (text: string) => text.replace(/\s+/g, ' ');

test('a step is dragged with its transitions, and alone with Alt', async () => {
  const page = await open(b, site, 'line.g7');
  const [x, y] = await place(page, 'G1/s/1');
  await drag(page, [x, y], [x + 120, y]);
  await page.waitForFunction(() => !!document.querySelector('button[aria-label="Undo"]:not(:disabled)'));
  const together = await textOf(page);
  assert.match(together, /step 1 at/);
  assert.match(together, /transition #0 at/);
  assert.match(together, /transition #1 at/);
  assert.doesNotMatch(together, /step 0 at|step 2 at|transition #2 at/);
  await page.locator('.sheet').focus();
  await page.keyboard.press('Control+z');
  await page.waitForFunction(() => !!document.querySelector('button[aria-label="Undo"]:disabled'));
  assert.equal(await textOf(page), LINE);
  const [nx, ny] = await place(page, 'G1/s/1');
  await page.keyboard.down('Alt');
  await drag(page, [nx, ny], [nx + 120, ny]);
  await page.keyboard.up('Alt');
  await page.waitForFunction(() => !!document.querySelector('button[aria-label="Undo"]:not(:disabled)'));
  const alone = await textOf(page);
  assert.match(alone, /step 1 at/);
  assert.doesNotMatch(alone, /transition #\d at/);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('a link from step to step gets a transition between them', async () => {
  const page = await open(b, site, 'line.g7');
  await click(page, 'G1/s/0');
  const handle = await page.locator('.handle').boundingBox();
  assert.ok(handle);
  await drag(page, [handle.x + 7, handle.y + 7], await place(page, 'G1/s/2'));
  await page.waitForFunction(() => document.querySelectorAll('.sheet [data-id^="G1/t/"]').length === 4);
  assert.match(words(await textOf(page)), /0 -> 2 when TRUE/);
  await page.context().close();
});

test('a step copied from one file into another gets a name of its own', async () => {
  const page = await open(b, site, 'other.g7');
  await click(page, 'G2/s/1');
  await page.keyboard.press('Control+c');
  await drawn(page);
  await page.getByRole('button', { name: 'line.g7' }).first().click();
  await item(page, 'G1/s/0').waitFor({ state: 'attached' });
  await page.locator('.sheet').focus();
  await page.keyboard.press('Control+v');
  await item(page, 'G1/s/3').waitFor({ state: 'attached' });
  const text = words(await textOf(page));
  assert.match(text, /step 3 \{ N M \}/);
  assert.match(text, /step 1 step 2/);
  await page.context().close();
});

test('names with the signs of ids are renamed, noted and read like others', async () => {
  const page = await open(b, site, 'line.g7');
  await click(page, 'G1/s/1');
  await page.keyboard.press('F2');
  await page.locator('.inplace > input').fill('Fill 2/3: 50 % > M');
  await page.keyboard.press('Enter');
  const id = 'G1/s/Fill 2%2F3%3A 50 %25 %3E M';
  await item(page, id).waitFor({ state: 'attached' });
  await click(page, id);
  await page.keyboard.press('c');
  await page.locator('.inplace > input').fill('half full');
  await page.keyboard.press('Enter');
  await page.locator('.inplace > input').waitFor({ state: 'detached' });
  await page.keyboard.press('a');
  await page.locator('.inplace > input').fill('P1 a');
  await page.keyboard.press('Enter');
  const action = page.locator('.sheet [data-part="action"], .sheet [data-id^="G1/a/"]').first();
  await action.waitFor({ state: 'attached' });
  assert.equal(await action.getAttribute('aria-label'), 'Action of step Fill 2/3: 50 % > M: P1 a');
  assert.match(words(await textOf(page)), /step `Fill 2\/3: 50 % > M` "half full" \{ P1 a \}/);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('names that are there twice are told, and every view stays', async () => {
  const page = await open(b, site, 'twice.g7', { width: 1440, height: 900 });
  await page.getByRole('button', { name: 'Drawing and text' }).click();
  await page.locator('.cm-content').waitFor();
  await page.getByRole('button', { name: 'Bottom' }).click();
  const tabs = page.locator('.bottom [role=tab]');
  for (let n = 0; n < (await tabs.count()); n++) {
    await tabs.nth(n).click();
    await page.locator('.bottom [role=tab][aria-selected=true]').nth(0).waitFor();
  }
  await page.getByRole('tab', { name: /Problems/ }).click();
  assert.ok((await page.locator('.bottom').innerText()).includes('G1'));
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('half a text leaves the last drawing, says so, and can be read', async () => {
  const page = await open(b, site, 'line.g7', { width: 1440, height: 900 });
  await page.getByRole('button', { name: 'Drawing and text' }).click();
  await page.locator('.cm-content').click();
  await page.keyboard.press('Control+End');
  // Behind the chart: it is drawn from the present text.
  for (const typed of ['\nchart {{ oops', '\ntest "', '\nchart ']) {
    await page.keyboard.type(typed);
    await page.locator('.cm-lint-marker-error').first().waitFor();
    await item(page, 'G1/s/2').waitFor({ state: 'attached' });
    await page.locator('.stale-note').waitFor({ state: 'detached' });
  }
  // A second chart of its name that cannot be read: the last drawing stays, and says so.
  await page.keyboard.type('\nchart G1 {\n step ');
  await page.locator('.stale-note').waitFor();
  await item(page, 'G1/s/2').waitFor({ state: 'attached' });
  await page.getByRole('button', { name: 'Bottom' }).click();
  await page.getByRole('tab', { name: 'Variables' }).click();
  await page.getByLabel('Type: a').waitFor();
  assert.deepEqual(await axe(page), []);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('nothing is asked of any other host', async () => {
  const context = await b.newContext({ viewport: { width: 1280, height: 720 }, locale: 'en-GB' });
  const page = await context.newPage();
  const hosts = new Set<string>();
  page.on('request', (r) => {
    const at = new URL(r.url());
    if (at.protocol !== 'data:' && at.protocol !== 'blob:') hosts.add(at.host);
  });
  await page.goto(site.url);
  await page.getByRole('button', { name: /Blank chart/ }).waitFor();
  assert.deepEqual([...hosts], [new URL(site.url).host]);
  await context.close();
});

test('fingers move the view, zoom it and select', async () => {
  const context = await b.newContext({ viewport: { width: 1024, height: 768 }, locale: 'en-GB', hasTouch: true });
  const page = await context.newPage();
  await page.goto(`${site.url}?file=line.g7`);
  await item(page, 'G1/s/1').waitFor({ state: 'attached' });
  await drawn(page);
  await page.touchscreen.tap(...(await place(page, 'G1/s/1')));
  await page.locator('.marks .selected').waitFor({ state: 'attached' });
  const finger = await context.newCDPSession(page);
  const touch = (type: 'touchStart' | 'touchMove' | 'touchEnd', ...touchPoints: { x: number; y: number; id: number }[]) =>
    finger.send('Input.dispatchTouchEvent', { type, touchPoints });
  const sheet = await page.locator('.sheet').boundingBox();
  assert.ok(sheet);
  const [x, y] = [sheet.x + sheet.width - 60, sheet.y + 120];
  const [, was] = await place(page, 'G1/s/1');
  await touch('touchStart', { x, y, id: 0 });
  for (let n = 1; n <= 8; n++) await touch('touchMove', { x, y: y + n * 10, id: 0 });
  await touch('touchEnd');
  await until(async () => Math.abs((await place(page, 'G1/s/1'))[1] - was - 80) < 15, 'the view went with the finger');
  const percent = async () => Number.parseInt(await page.locator('.zoom .percent').innerText(), 10);
  const zoom = await percent();
  const pair = (d: number) => [{ x: x - 80 - d, y, id: 0 }, { x: x - 80 + d, y, id: 1 }];
  await touch('touchStart', ...pair(20));
  for (let n = 1; n <= 8; n++) await touch('touchMove', ...pair(20 + n * 4));
  await touch('touchEnd');
  await until(async () => (await percent()) > zoom, 'two fingers zoom');
  await context.close();
});
