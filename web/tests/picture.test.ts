// Stories of the picture editor: a plant without a picture gets one, whose parts follow the run; a picture that was drawn
// elsewhere stays to the byte where nobody changed it.
import assert from 'node:assert/strict';
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import type { Locator } from 'playwright-core';
import { picture as words } from '../src/lib/words/picture';
import { scaled, unscaled, type Offer } from '../src/picture/effects';
import { framed, frameOf, placeOf, transformOf } from '../src/picture/frame';
import { spliced, Unreadable } from '../src/picture/markup';
import { pictureOf, withFrame, without } from '../src/picture/things';
import { telephone } from './finger';
import { axe, box, browser, done, open, playground, serve, textOf, until, type Opened, type Site } from './lib';

const example = (path: string) => readFileSync(new URL(`../../examples/${path}`, import.meta.url), 'utf8');

const TANK = `input go, full : BOOL
output fill, lamp : BOOL

chart Fill {
  initial step 0
  step 1 { N fill  N lamp }
  0 -> 1 when ↑go
  1 -> 0 when full
}

plant Tank { // of water
  state level : REAL := 20.0 in 0.0 .. 100.0
  state rod : REAL in 0.0 .. 2.0
  rate level := 10.0 when fill
  rate rod := 0.2 when fill
  drive full := level > 95.0
}
`;

/** A picture as a drawing program writes it: with a layer, elements that no page shows, and entities. */
const FOREIGN = `<?xml version="1.0"?>
<!DOCTYPE svg>
<svg xmlns="http://www.w3.org/2000/svg" xmlns:odd="urn:odd" viewBox="0 0 300 200">
  <!-- <rect> no element -->
  <odd:view  a = '1'/>
  <style><![CDATA[ .x > .y { fill: red } ]]></style>
  <g id='layer1' odd:mode="layer">
    <rect   x="20" y="20"  width="60" height="40" fill='#8af' odd:label="A &amp; B"/>
    <g data-g7="swing" transform="rotate(10)"><circle cx="150" cy="60" r="20"/></g>
    <image x="200" y="20" width="40" height="40" href="elsewhere.png"/>
  </g>
</svg>
`;

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({
    'tank.g7': TANK,
    'gemma.g7': example('structure/gemma.g7'),
    'press.svg': example('structure/press.svg'),
    'odd.g7': TANK.replace('full := level > 95.0\n', "full := level > 95.0\n  view 'odd.svg'\n"),
    'odd.svg': FOREIGN,
  });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

const editor = (page: Opened) => page.getByRole('dialog', { name: /^Picture of/ });
const thing = (page: Opened, n: number) => editor(page).locator(`[data-thing="${n}"]`);

async function draw(page: Opened, name = 'Draw picture'): Promise<Locator> {
  await page.getByRole('tab', { name: 'Operate' }).click();
  await page.getByRole('button', { name }).click();
  await editor(page).locator('.page').waitFor();
  return editor(page);
}

/** Drags one thing onto another, or onto a place of the sheet. */
async function drag(page: Opened, what: Locator, to: Locator, at?: { x: number; y: number }): Promise<void> {
  const [from, goal] = [await box(what), await box(to)];
  await page.mouse.move(from.x + from.width / 2, from.y + from.height / 2);
  await page.mouse.down();
  await page.mouse.move(from.x + from.width / 2 + 10, from.y + from.height / 2 + 10);
  await page.mouse.move(goal.x + (at?.x ?? goal.width / 2), goal.y + (at?.y ?? goal.height / 2), { steps: 4 });
  await page.mouse.up();
}

/** Puts a part on the sheet at a place of it, in px. */
const part = (page: Opened, id: string, at: { x: number; y: number }) => drag(page, editor(page).locator(`[data-part="${id}"]`), editor(page).locator('.page'), at);
const bind = (page: Opened, name: string, n: number) => drag(page, editor(page).locator(`[data-name="${name}"]`), thing(page, n));

/** Saves the picture; the text that the window keeps of it. */
async function saved(page: Opened, name: string): Promise<string> {
  await editor(page).getByRole('button', { name: 'Save picture' }).click();
  await editor(page).getByRole('status').filter({ hasText: `${name} is kept in this window` }).waitFor();
  return page.evaluate((name) => (JSON.parse(sessionStorage.getItem('g7-guests') ?? '{}') as Record<string, string>)[name] ?? '', name);
}

const VIEW = `  drive full := level > 95.0
  view 'tank.svg' {
    tank1_liquid.level := level / 100.0
    lamp1.on := lamp
    cylinder1_rod.dx := rod * 38.0 / 2.0
  }
}
`;

test('a tank, a lamp and a cylinder are drawn, bound by dragging, saved, and move while the chart runs', async () => {
  const page = await open(b, site, 'tank.g7');
  const dialog = await draw(page);
  await part(page, 'tank', { x: 120, y: 160 });
  await part(page, 'lamp', { x: 300, y: 80 });
  await part(page, 'cylinder', { x: 420, y: 260 });
  assert.equal(await dialog.locator('[data-thing]').count(), 3);
  await bind(page, 'level', 0);
  await bind(page, 'lamp', 1);
  // A cylinder has one effect for a number.
  await bind(page, 'rod', 2);
  await dialog.getByText('cylinder1_rod.dx').waitFor();
  assert.equal(await dialog.getByLabel('Greatest value of cylinder1_rod.dx').inputValue(), '2', 'the limits of the state');
  assert.deepEqual(await axe(page), []);
  const file = await saved(page, 'tank.svg');
  assert.match(file, /^<svg xmlns="http:\/\/www.w3.org\/2000\/svg" viewBox="0 0 400 240"/);
  assert.doesNotMatch(file, /data-thing/, 'nothing of the editor stays in the file');
  await dialog.getByRole('button', { name: 'Close' }).click();
  await page.getByRole('button', { name: 'Run', exact: true }).first().click();
  const shown = page.locator('.picture');
  await shown.locator('[data-g7="tank1_liquid"]').waitFor();
  const of = (name: string) => shown.locator(`[data-g7="${name}"]`);
  const look = async () => ({
    level: await of('tank1_liquid').evaluate((e) => (e as SVGElement).style.scale),
    lit: await of('lamp1').evaluate((e) => e.classList.contains('on')),
    rod: await of('cylinder1_rod').evaluate((e) => parseFloat((e as SVGElement).style.translate)),
  });
  assert.deepEqual(await look(), { level: '1 0.2', lit: false, rod: 0 });
  await page.getByRole('switch', { name: 'Switch go' }).click();
  await until(async () => (await look()).lit, 'the lamp is lit');
  await until(async () => Number((await look()).level.split(' ')[1]) > 0.3 && (await look()).rod > 3, 'level and rod move');
  const now = await look();
  // Both are at the same time of the run: 1 % of level is 0.02 of the rod.
  assert.ok(Math.abs((Number(now.level.split(' ')[1]) - 0.2) * 38 - now.rod) < 4, JSON.stringify(now));
  assert.equal(await textOf(page), TANK.replace('  drive full := level > 95.0\n}\n', VIEW));
  await page.locator('.sheet').focus();
  await page.keyboard.press('Control+z');
  await until(async () => (await textOf(page)) === TANK, 'one undo takes the view back');
  await done(page);
});

test('a picture of an example opens, one thing is moved, and all else stays to the byte', async () => {
  const page = await open(b, site, 'gemma.g7');
  const before = example('structure/press.svg');
  const dialog = await draw(page, 'Edit picture');
  // The work piece is the third of the things: behind the box and the rod.
  await drag(page, thing(page, 2), dialog.locator('.page'), { x: 300, y: 300 });
  const after = await saved(page, 'press.svg');
  const piece = '<rect class="piece" x="290" y="34" width="24" height="32" rx="2"/>';
  const wrapped = /<g transform="translate\(-?[\d.]+ -?[\d.]+\)"><rect class="piece"[^>]*\/><\/g>/;
  assert.match(after, wrapped);
  assert.equal(after.replace(wrapped, piece), before);
  await dialog.getByRole('button', { name: 'Close' }).click();
  assert.equal(await textOf(page), example('structure/gemma.g7'), 'the bindings stay as they were written');
  await done(page);
});

test('what no part of the palette is stays as it is, and can be bound and deleted as a whole', async () => {
  const page = await open(b, site, 'odd.g7');
  const dialog = await draw(page, 'Edit picture');
  assert.equal(await dialog.locator('[data-thing]').count(), 3, 'the things of the only layer');
  await bind(page, 'fill', 0);
  await dialog.getByRole('menuitem', { name: 'visible' }).click();
  await dialog.getByText('rect1.visible').waitFor();
  // Its transform would turn it about the wrong place, so a group round it is what a binding moves.
  await bind(page, 'level', 1);
  await dialog.getByRole('menuitem', { name: 'angle' }).click();
  await dialog.getByText('swing.rotate').waitFor();
  const bound = await saved(page, 'odd.svg');
  assert.equal(bound, FOREIGN.replace(`odd:label="A &amp; B"`, `odd:label="A &amp; B" data-g7="rect1"`));
  await dialog.getByRole('combobox', { name: 'On the sheet' }).selectOption({ label: 'swing' });
  await dialog.locator('.page').focus();
  await page.keyboard.press('Delete');
  const after = await saved(page, 'odd.svg');
  assert.equal(after, bound.replace('\n    <g data-g7="swing" transform="rotate(10)"><circle cx="150" cy="60" r="20"/></g>', ''));
  await page.keyboard.press('Escape');
  await dialog.waitFor({ state: 'detached' });
  assert.equal(await textOf(page), TANK.replace('full := level > 95.0\n', "full := level > 95.0\n  view 'odd.svg' {\n    rect1.visible := fill\n  }\n"));
  await done(page);
});

test('with the keyboard alone a lamp is put, moved, bound, copied, and all of it taken back', async () => {
  const page = await open(b, site, 'tank.g7');
  await page.getByRole('tab', { name: 'Operate' }).focus();
  await page.keyboard.press('Enter');
  await page.getByRole('button', { name: 'Draw picture' }).focus();
  await page.keyboard.press('Enter');
  const dialog = editor(page);
  await dialog.locator('.page').waitFor();
  await dialog.getByRole('button', { name: 'Add: Lamp' }).focus();
  await page.keyboard.press('Enter');
  const left = dialog.getByRole('spinbutton', { name: 'Left' });
  const at = Number(await left.inputValue());
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('Shift+ArrowLeft');
  assert.equal(Number(await left.inputValue()), at + 19, 'two steps of the grid, less one unit');
  await dialog.getByRole('button', { name: /^lamp/ }).focus();
  await page.keyboard.press('Enter');
  await dialog.getByText('lamp1.on').waitFor();
  await dialog.locator('.page').focus();
  await page.keyboard.press('Control+d');
  await dialog.getByRole('combobox', { name: 'On the sheet' }).and(dialog.locator(':has(option:checked:text("lamp2"))')).waitFor();
  assert.equal(await dialog.getByText('lamp2.on').count(), 0, 'a copy follows nothing');
  await page.keyboard.press('Control+a');
  await dialog.getByRole('combobox', { name: 'On the sheet' }).and(dialog.locator(':has(option:checked:text("2 selected"))')).waitFor();
  for (let n = 0; n < 12 && (await dialog.locator('[data-thing]').count()) > 0; n++) await page.keyboard.press('Control+z');
  assert.equal(await dialog.locator('[data-thing]').count(), 0, 'undone to the empty sheet');
  for (let n = 0; n < 12 && (await dialog.getByRole('button', { name: 'Redo' }).isEnabled()); n++) await page.keyboard.press('Control+y');
  assert.equal(await dialog.locator('[data-thing]').count(), 2, 'and done again');
  await page.keyboard.press('Control+s');
  await dialog.getByRole('status').filter({ hasText: 'tank.svg is kept' }).waitFor();
  await page.keyboard.press('Escape');
  await page.keyboard.press('Escape');
  await dialog.waitFor({ state: 'detached' });
  assert.match(await textOf(page), /view 'tank\.svg' \{\n {4}lamp1\.on := lamp\n {2}\}/);
  await done(page);
});

test('a picture with changes is not closed without a word', async () => {
  const page = await open(b, site, 'tank.g7');
  const dialog = await draw(page);
  await dialog.getByRole('button', { name: 'Add: Motor' }).click();
  await dialog.getByRole('button', { name: 'Close', exact: true }).click();
  await dialog.getByRole('alertdialog').getByRole('button', { name: 'Cancel' }).click();
  assert.equal(await dialog.locator('[data-thing]').count(), 1, 'it goes on');
  await dialog.getByRole('button', { name: 'Close', exact: true }).click();
  await dialog.getByRole('button', { name: 'Close without saving' }).click();
  await dialog.waitFor({ state: 'detached' });
  assert.equal(await textOf(page), TANK);
  await done(page);
});

test('in a folder the picture is a file, and another one of its name is not overwritten unseen', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'g7-picture-'));
  const svg = join(folder, 'tank.svg');
  writeFileSync(join(folder, 'tank.g7'), TANK);
  const server = await serve(folder);
  try {
    const page = await open(b, server, 'tank.g7');
    const dialog = await draw(page);
    await dialog.getByRole('button', { name: 'Add: Tank' }).click();
    await dialog.getByRole('button', { name: /^level/ }).click();
    await dialog.getByRole('button', { name: 'Save picture' }).click();
    await dialog.getByRole('status').filter({ hasText: 'tank.svg saved' }).waitFor();
    const first = readFileSync(svg, 'utf8');
    assert.match(first, /data-g7="tank1_liquid"/);
    writeFileSync(svg, first.replace('viewBox="0 0 400 240"', 'viewBox="0 0 500 240"'));
    await dialog.getByRole('button', { name: 'Add: Motor' }).click();
    await dialog.getByRole('button', { name: 'Save picture' }).click();
    await dialog.getByRole('status').filter({ hasText: 'tank.svg was changed elsewhere' }).waitFor();
    assert.match(readFileSync(svg, 'utf8'), /viewBox="0 0 500 240"/, 'what somebody else wrote is there');
    await dialog.getByRole('button', { name: 'Save picture' }).click();
    await dialog.getByRole('status').filter({ hasText: 'tank.svg saved' }).waitFor();
    assert.match(readFileSync(svg, 'utf8'), /data-g7="motor1"/, 'saving again replaces it');
    await dialog.getByRole('button', { name: 'Close' }).click();
    assert.equal(readFileSync(join(folder, 'tank.g7'), 'utf8'), TANK, 'the chart is saved by its own key');
    await page.locator('.sheet').focus();
    await page.keyboard.press('Control+s');
    await until(async () => readFileSync(join(folder, 'tank.g7'), 'utf8').includes("view 'tank.svg' {\n    tank1_liquid.level := level / 100.0\n  }"), 'it has the view');
    // The server refused one text, of which the browser tells.
    assert.deepEqual(page.errors.filter((e) => !e.includes('412')), []);
    await page.context().close();
  } finally {
    await server.stop();
    rmSync(folder, { recursive: true, force: true });
  }
});

test('a picture that is saved while the chart runs is shown at once', async () => {
  const page = await open(b, site, 'gemma.g7');
  await page.getByRole('tab', { name: 'Operate' }).click();
  await page.getByRole('button', { name: 'Run', exact: true }).first().click();
  await page.locator('.picture [data-g7="rod"]').waitFor();
  await page.getByRole('button', { name: 'Edit picture' }).click();
  const dialog = editor(page);
  await dialog.getByRole('button', { name: 'Add: Lamp' }).click();
  await dialog.getByRole('button', { name: /^advance/ }).click();
  await saved(page, 'press.svg');
  assert.equal(await page.locator('.picture [data-g7="lamp1"]').count(), 1, 'the panel has it');
  await dialog.getByRole('button', { name: 'Close' }).click();
  await done(page);
});

test('a number goes from one end of its effect to the other as its variable goes through its range', () => {
  const ends: [from: number, to: number][] = [[0, 1], [0, 38], [-120, 120], [0, -100], [5, 5.5], [0, 360]];
  const ranges: [from: number, to: number][] = [[0, 100], [0, 1], [5, 25], [-10, 10], [-3, -2.5], [100, 0]];
  for (const value of ['level', 'level - 1.0'])
    for (const [from, to] of ends)
      for (const range of ranges) {
        const offer: Offer = { element: 'a', attribute: 'dx', kind: 'number', from, to };
        const written = scaled(value, offer, range);
        const at = (level: number) => new Function('level', `return ${written}`)(value === 'level' ? level : level + 1) as number;
        assert.ok(Math.abs(at(range[0]) - from) < 1e-6 && Math.abs(at(range[1]) - to) < 1e-6, `${written} for ${String(range)} to ${from} .. ${to}`);
        assert.deepEqual(unscaled(written, value, offer), range, `the range of ${written}`);
      }
  const level: Offer = { element: 'a', attribute: 'level', kind: 'number', from: 0, to: 1 };
  assert.equal(scaled('level', level, [0, 100]), 'level / 100.0', 'nothing more than is needed');
  assert.equal(unscaled('level / 50.0 + wave', 'level', level), null, 'what someone else wrote');
});

test('a frame puts a thing where it is said to be, turned and sized', () => {
  const box = { x: 7, y: -3, width: 40, height: 20 };
  const place = { cx: 100, cy: 60, w: 80, h: 10, angle: 30 };
  const frame = frameOf(transformOf(framed(place, box)));
  assert.ok(frame);
  const found = placeOf(frame, box);
  for (const key of ['cx', 'cy', 'w', 'h', 'angle'] as const) assert.ok(Math.abs(found[key] - place[key]) < 0.01, `${key} ${found[key]}`);
  for (const other of ['matrix(1 0 0 1 2 3)', 'translate(1,2) skewX(3)', 'translate(1 2) scale(-1 1)', undefined]) assert.equal(frameOf(other), null, String(other));
});

test('a thing is moved and taken away without a change of anything else', () => {
  const picture = pictureOf(FOREIGN);
  const [first, second] = picture.things;
  assert.ok(first && second);
  const frame = { x: 10, y: 0, angle: 0, sx: 1, sy: 1 };
  const moved = spliced(FOREIGN, withFrame(FOREIGN, first, frame));
  assert.equal(moved.replace('<g transform="translate(10 0)">', '').replace('odd:label="A &amp; B"/></g>', 'odd:label="A &amp; B"/>'), FOREIGN);
  const again = pictureOf(moved).things[0];
  assert.ok(again?.frame, 'its frame is known again');
  assert.equal(spliced(moved, withFrame(moved, again, { ...frame, x: 0, y: 5 })), moved.replace('translate(10 0)', 'translate(0 5)'));
  assert.equal(pictureOf(spliced(FOREIGN, without(picture, new Set([0])))).things.length, 2);
  for (const wrong of ['', '<svg>', '<svg><g></svg>', '<html></html>', '<svg></svg><svg></svg>', '<!-- <svg/>', '<svg a="></svg>', '<s:svg xmlns:s="http://www.w3.org/2000/svg"/>'])
    assert.throws(() => pictureOf(wrong), Unreadable);
});

test('each part has a name in each language, and is bound in the picture that uses all', () => {
  const parts = readdirSync(new URL('../../examples/parts/', import.meta.url)).filter((name) => name.endsWith('.svg') && name !== 'gallery.svg');
  assert.ok(parts.length >= 15);
  const chart = example('parts/gallery.g7');
  const shown = pictureOf(example('parts/gallery.svg')).things;
  for (const name of parts) {
    const id = name.replace('.svg', '');
    assert.ok(`picture.part.${id}` in words, id);
    const things = shown.filter((t) => t.part === id);
    assert.equal(things.length, 1, id);
    assert.ok(things.every((t) => t.hands.length > 0 || t.names.some((n) => chart.includes(`    ${n}.`))), `${id} follows something`);
  }
});

test('a picture is drawn on a telephone, in French', async () => {
  const hand = await telephone(b, site, 'tank.g7', undefined, { language: 'fr' });
  const { page } = hand;
  await hand.press('Conduite');
  await hand.press('Dessiner l’image');
  const dialog = page.getByRole('dialog', { name: 'Image de Tank' });
  await dialog.locator('.page').waitFor();
  await hand.press('Ajouter : Cuve');
  await hand.press('Variables');
  assert.deepEqual(await hand.unfit(), []);
  // The part that was just put is selected, so a tap on a variable binds it.
  await dialog.getByRole('button', { name: /^level/ }).tap();
  await dialog.getByText('tank1_liquid.level').waitFor();
  assert.deepEqual(await hand.unfit(), []);
  assert.deepEqual(await axe(page), []);
  const before = await box(dialog.locator('[data-thing="0"]'));
  const from: [number, number] = [before.x + before.width / 2, before.y + before.height / 2];
  await hand.slide([from], [[from[0] + 60, from[1]]]);
  await until(async () => (await box(dialog.locator('[data-thing="0"]'))).x > before.x + 30, 'a finger moves it');
  await hand.press('Enregistrer l’image');
  await dialog.getByRole('status').filter({ hasText: 'tank.svg est gardé' }).waitFor();
  await page.context().close();
});
