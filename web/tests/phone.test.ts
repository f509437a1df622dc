// The editor on a telephone, upright and on its side: bars that fit, sheets, and drawing with fingers.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { words } from './table';
import { LYING, telephone, UPRIGHT, type Hand } from './finger';
import { axe, box, browser, core, drawn, item, playground, until, type Site } from './lib';

const LINE = 'input go, back : BOOL\noutput motor : BOOL\n\nchart G1 {\n  initial step 0\n  step 1 {\n    N motor\n  }\n  step 2\n  0 -> 1 when go\n  1 -> 2 when back\n  2 -> 0 when not go\n}\n';

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'cell/line.g7': LINE });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

const field = (hand: Hand) => hand.page.locator('.inplace > input');
const square = (hand: Hand, id: string) => item(hand.page, id).locator('.g7-box, .g7-bar').first();

/** Types into the open field, in place of what is there. */
async function type(hand: Hand, text: string): Promise<void> {
  await field(hand).waitFor();
  await field(hand).fill(text);
}

for (const [name, size] of [['upright', UPRIGHT], ['lying', LYING]] as const) {
  test(`every command is in reach of a finger, ${name}`, async () => {
    const hand = await telephone(b, site, 'cell/line.g7', size);
    const { page } = hand;
    assert.deepEqual(await hand.unfit(), [], 'the drawing');
    assert.equal((await page.getByRole('tablist', { name: 'Open files' }).innerText()).trim(), 'line.g7', 'the name of the file is read');
    const name = await page.locator('[role=tablist] .name').evaluate((e) => e.scrollWidth <= e.clientWidth);
    assert.ok(name, 'and not cut off');
    await hand.choose('G1/s/1');
    assert.deepEqual(await hand.unfit(), [], 'a selected step');
    await hand.press('More of the run');
    assert.deepEqual(await hand.unfit(), [], 'the rest of the bar of the run');
    await hand.press('More of the run');
    await hand.press('Run');
    await hand.press('Operate');
    await page.getByRole('tab', { name: 'Operate', selected: true }).waitFor();
    assert.deepEqual(await hand.unfit(), [], 'operate');
    await hand.press('Panels');
    assert.equal(await page.getByRole('tab', { name: 'Operate' }).count(), 0, 'one sheet at a time is open');
    for (const panel of ['Problems', 'Variables', 'Inputs and outputs', 'Tests', 'Prove', 'Compare', 'Export', 'Chronogram']) {
      await page.getByRole('tab', { name: panel }).tap();
      assert.deepEqual(await hand.unfit(), [], panel);
    }
    await page.getByRole('region', { name: 'Bottom' }).getByRole('button', { name: 'Close', exact: true }).tap();
    assert.equal(await page.getByRole('tab', { name: 'Problems' }).count(), 0, 'a sheet closes');
    await hand.press('Files');
    assert.deepEqual(await hand.unfit(), [], 'files');
    await hand.press('Text');
    await page.locator('.cm-content').waitFor();
    assert.deepEqual(await hand.unfit(), [], 'text');
    for (const dialog of ['Settings', 'Keyboard shortcuts']) {
      await hand.press('More');
      assert.deepEqual(await hand.unfit(), [], 'the menu');
      await hand.press(dialog);
      await page.getByRole('dialog', { name: dialog }).waitFor();
      assert.deepEqual(await hand.unfit(), [], dialog);
      await page.getByRole('dialog', { name: dialog }).getByRole('button', { name: 'Close', exact: true }).tap();
    }
    await page.getByRole('button', { name: 'Gallery' }).tap();
    await page.getByRole('button', { name: /Blank chart/ }).waitFor();
    assert.deepEqual(await hand.unfit(), [], 'the gallery');
    await page.context().close();
  });
}

test('a chart of three steps is drawn, named and run with fingers alone', async () => {
  const hand = await telephone(b, site);
  const { page } = hand;
  await page.getByRole('button', { name: /Blank chart/ }).tap();
  await hand.choose('G1/s/0');
  for (const receptivity of ['go', 'full']) {
    await hand.press('Next transition and step');
    await type(hand, receptivity);
    await page.locator('.inplace').getByRole('button', { name: /^Declare/ }).tap();
    await field(hand).waitFor({ state: 'detached' });
    await drawn(page);
  }
  // A link back to the first step is drawn from the handle of the last one.
  await hand.choose('G1/s/2');
  await hand.slide([await hand.middle(page.getByRole('button', { name: 'Drag to link' }))], [await core(page, 'G1/s/0')]);
  await until(async () => (await page.locator('.sheet [data-id^="G1/t/"]').count()) === 3, 'a transition leads back');
  // Its receptivity is asked for.
  await type(hand, '1');
  await hand.press('Done');
  await field(hand).waitFor({ state: 'detached' });
  for (const [id, name, action] of [['1', 'fill', 'valve'], ['2', 'stir', 'motor']] as const) {
    await hand.tapTwice(await core(page, `G1/s/${id}`));
    await type(hand, name);
    await hand.press('Done');
    await hand.choose(`G1/s/${name}`);
    await page.getByRole('button', { name: 'Action', exact: true }).tap();
    await type(hand, action);
    await page.locator('.inplace').getByRole('button', { name: /^Declare/ }).tap();
    await item(page, `G1/a/${name}/0`).waitFor({ state: 'attached' });
  }
  await hand.press('Run');
  await hand.press('Operate');
  await page.getByRole('switch', { name: 'Switch go' }).tap();
  await hand.press('Drawing');
  await page.locator('.sheet [data-id="G1/s/fill"][aria-label*="active"]').waitFor({ state: 'attached' });
  await page.context().close();
});

test('a finger moves what is selected, and the view elsewhere', async () => {
  const hand = await telephone(b, site, 'cell/line.g7');
  const { page } = hand;
  const place = async (id: string) => hand.middle(square(hand, id));
  const [x, y] = await place('G1/s/1');
  await hand.slide([[x, y]], [[x, y - 60]]);
  const panned = await place('G1/s/1');
  assert.ok(Math.abs(panned[1] - (y - 60)) < 14, 'a step that is not selected leaves with the view');
  const apart = async () => (await place('G1/s/1'))[0] - (await place('G1/s/0'))[0];
  assert.ok(Math.abs(await apart()) < 1);
  await hand.choose('G1/s/1');
  const [sx, sy] = await place('G1/s/1');
  await hand.slide([[sx, sy]], [[sx + 60, sy]]);
  await until(async () => Math.abs((await apart()) - 60) < 14, 'a selected step moves alone');
  await page.context().close();
});

test('two fingers zoom round the place between them', async () => {
  const hand = await telephone(b, site, 'cell/line.g7');
  const { page } = hand;
  const size = async () => (await box(square(hand, 'G1/s/1'))).width;
  const [x, y] = await hand.middle(square(hand, 'G1/s/1'));
  const was = await size();
  await hand.slide([[x - 30, y], [x + 30, y]], [[x - 60, y], [x + 60, y]]);
  await until(async () => Math.abs((await size()) / was - 2) < 0.25, 'twice as far apart, twice as large');
  const [nx, ny] = await hand.middle(square(hand, 'G1/s/1'));
  assert.ok(Math.hypot(nx - x, ny - y) < 20, `what was between the fingers stays there: ${nx - x}, ${ny - y}`);
  await page.context().close();
});

test('a long press opens the menu of the symbol, and of the paper', async () => {
  const hand = await telephone(b, site, 'cell/line.g7');
  const { page } = hand;
  const menu = page.getByRole('menu', { name: 'Menu of the symbol' });
  await hand.hold(await core(page, 'G1/s/1'), menu);
  await menu.getByRole('menuitem', { name: 'Rename everywhere' }).tap();
  await field(hand).waitFor();
  await hand.press('Cancel');
  const sheet = await box(page.locator('.sheet'));
  await hand.hold([sheet.x + 60, sheet.y + sheet.height - 100], menu);
  await menu.getByRole('menuitem', { name: 'Add a step' }).tap();
  await until(async () => (await page.locator('.sheet [data-id^="G1/s/"]').count()) === 4, 'a new step');
  await page.context().close();
});

test('a key presses in the menu that a long press has opened', async () => {
  const hand = await telephone(b, site, 'cell/line.g7');
  const { page } = hand;
  const menu = page.getByRole('menu');
  await hand.hold(await core(page, 'G1/s/1'), menu);
  await menu.getByRole('menuitem', { name: 'Rename' }).focus();
  await page.keyboard.press('Enter');
  await field(hand).waitFor();
  assert.equal(await field(hand).inputValue(), '1');
  await page.context().close();
});

test('the buttons of a selected symbol cover no other symbol', async () => {
  const hand = await telephone(b, site, 'cell/line.g7');
  const { page } = hand;
  await drawn(page);
  for (const id of ['G1/s/0', 'G1/t/0', 'G1/s/1', 'G1/t/1', 'G1/s/2', 'G1/t/2']) {
    await hand.choose(id);
    const covered = () =>
      page.evaluate((own) => {
        const near = document.querySelector('.near')?.getBoundingClientRect();
        if (!near) return ['no buttons'];
        const symbols = [...document.querySelectorAll<HTMLElement>('.sheet [data-id]')].filter((e) => e.dataset.id !== own);
        const cores = symbols.flatMap((e) => [...e.querySelectorAll('.g7-box, .g7-bar, .g7-action')].map((core) => [e.dataset.id, core.getBoundingClientRect()] as const));
        return cores.filter(([, r]) => r.left < near.right && r.right > near.left && r.top < near.bottom && r.bottom > near.top).map(([other]) => other ?? '');
      }, id);
    // The buttons find their place when their size is known.
    let found: string[] = [];
    await until(async () => (found = await covered()).length === 0, `the buttons of ${id} cover no symbol`, 5_000).catch(() => assert.deepEqual(found, [], id));
  }
  await page.context().close();
});

for (const [name, size] of [['upright', UPRIGHT], ['lying', LYING]] as const) {
  test(`the table of variables needs no sideways scroll, ${name}`, async () => {
    const hand = await telephone(b, site, 'cell/line.g7', size);
    const { page } = hand;
    await hand.press('Panels');
    await page.getByRole('tab', { name: 'Variables' }).tap();
    await page.getByRole('textbox', { name: 'Name: go' }).waitFor();
    const beyond = await page.locator('tbody :is(input, select, button)').evaluateAll((all) =>
      all.filter((e) => e.getBoundingClientRect().right > innerWidth).map((e) => e.getAttribute('aria-label')),
    );
    assert.deepEqual(beyond, []);
    // The name and the value are on one line.
    const [of, value] = await Promise.all(['Name: go', 'Initial value: go'].map((label) => box(page.getByRole('textbox', { name: label, exact: true }))));
    assert.ok(Math.abs((of?.y ?? 0) - (value?.y ?? 1e3)) < 4);
    await page.getByRole('textbox', { name: 'Comment: go' }).fill('the green button');
    await page.getByRole('textbox', { name: 'Comment: go' }).press('Enter');
    await until(async () => (await page.getByRole('textbox', { name: 'Comment: go' }).inputValue()) === 'the green button', 'a field of a card is edited');
    await page.context().close();
  });
}

test('the keyboard of the screen does not cover the field that is typed in', async () => {
  const hand = await telephone(b, site, 'cell/line.g7');
  const { page } = hand;
  await hand.tapTwice(await core(page, 'G1/t/2'));
  await field(hand).waitFor();
  // Chromium without a screen has no keyboard: the page hears of it as a browser tells it.
  const KEYBOARD = 340;
  const seen = UPRIGHT.height - KEYBOARD;
  const tell = (height: number) =>
    page.evaluate((h) => {
      Object.defineProperty(window.visualViewport, 'height', { configurable: true, value: h });
      window.visualViewport?.dispatchEvent(new Event('resize'));
    }, height);
  await tell(seen);
  const within = async () => {
    const at = await box(page.locator('.inplace'));
    return at.y >= 0 && at.y + at.height <= seen;
  };
  await until(within, 'the field and its buttons are above the keyboard');
  await tell(UPRIGHT.height);
  await until(async () => (await page.getByRole('button', { name: 'Operate', exact: true }).count()) === 1, 'without a keyboard the lower bar is back');
  await page.context().close();
});

for (const [n, language] of (['en', 'fr', 'pt'] as const).entries()) {
  test(`axe finds nothing wrong on a telephone, ${language}`, async () => {
    const word = (english: string) => words.find((row) => row[0] === english)?.[n] ?? english;
    const hand = await telephone(b, site, 'cell/line.g7', UPRIGHT, { language });
    const { page } = hand;
    const right = async (place: string) => assert.deepEqual(await axe(page), [], place);
    await hand.choose('G1/s/1');
    await right('the drawing');
    await hand.press(word('More of the run'));
    await right('the rest of the bar of the run');
    await hand.press(word('More of the run'));
    await hand.tapTwice(await core(page, 'G1/t/2'));
    await field(hand).waitFor();
    await right('a field');
    await hand.press(word('Cancel'));
    await hand.press(word('One scan'));
    await hand.press(word('Operate'));
    await right('operate');
    await page.getByRole('tab', { name: word('Properties') }).tap();
    await right('properties');
    await hand.press(word('Panels'));
    for (const panel of ['Problems', 'Variables', 'Inputs and outputs', 'Tests', 'Prove', 'Compare', 'Export', 'Chronogram']) {
      await page.getByRole('tab', { name: word(panel) }).tap();
      await right(panel);
    }
    await hand.press(word('Files'));
    await right('files');
    await hand.press(word('Text'));
    await page.locator('.cm-content').waitFor();
    await right('text');
    for (const dialog of ['Settings', 'Keyboard shortcuts']) {
      await hand.press(word('More'));
      await hand.press(word(dialog));
      await page.getByRole('dialog', { name: word(dialog) }).waitFor();
      await right(dialog);
      await page.getByRole('dialog', { name: word(dialog) }).getByRole('button', { name: word('Close'), exact: true }).tap();
    }
    await page.getByRole('button', { name: word('Gallery') }).tap();
    await page.locator('main.start').waitFor();
    await right('the gallery');
    await page.context().close();
  });
}
