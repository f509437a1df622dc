// The page for screen readers: names, roles and states of all that can be operated, the symbols of the drawing, and
// changes that come by themselves. Also: nothing moves for those who asked for that.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { words as table } from './table';
import { browser, done, drawn, item, openWith, playground, press, until, type Opened, type Site } from './lib';

const CHART =
  'input go : BOOL\noutput motor, lamp : BOOL\n\nchart G1 {\n  initial step 0\n  step 1 {\n    N motor\n  }\n  step 2 {\n    N lamp\n  }\n  0 -> 1 when go\n  1 -> 2 when not go\n  2 -> 0 when go\n}\n\ntest "moves" {\n  set go := TRUE\n  wait 1s\n  expect X1\n}\n';
const CLOCK = 'output a, b : BOOL\n\nchart G1 {\n  initial step 0 {\n    N a\n  }\n  step 1 {\n    N b\n  }\n  0 -> 1 when 100ms/X0\n  1 -> 0 when 100ms/X1\n}\n';

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'line.g7': CHART, 'clock.g7': CLOCK, 'wrong.g7': 'chart G1 {\n initial step 0\n step 1\n 0 -> 1 when missing\n}\n' });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

interface Node {
  role: string;
  name: string;
  states: string[];
}

const OPERATED = new Set(['button', 'checkbox', 'combobox', 'link', 'listbox', 'menuitem', 'menuitemcheckbox', 'menuitemradio', 'option', 'radio', 'searchbox', 'slider', 'spinbutton', 'switch', 'tab', 'textbox', 'application']);

/** The tree that the browser gives to screen readers. */
async function tree(page: Page): Promise<Node[]> {
  const reader = await page.context().newCDPSession(page);
  const { nodes } = await reader.send('Accessibility.getFullAXTree');
  await reader.detach();
  return nodes
    .filter((n) => !n.ignored)
    .map((n) => ({ role: String(n.role?.value ?? ''), name: String(n.name?.value ?? ''), states: (n.properties ?? []).map((p) => `${p.name}=${String(p.value.value)}`) }));
}

const named = (nodes: Node[], role: string, name: string) => nodes.find((n) => n.role === role && n.name === name);

/** Everything that can be operated has a name, in the language of the page. */
function wellNamed(nodes: Node[], language: 'en' | 'fr' | 'pt', where: string): void {
  const operated = nodes.filter((n) => OPERATED.has(n.role));
  assert.ok(operated.length > 8, `${where}: ${operated.length} things to operate`);
  assert.deepEqual(operated.filter((n) => n.name.trim() === '').map((n) => n.role), [], `${where}, ${language}: without a name`);
  if (language === 'en') return;
  const at = language === 'fr' ? 1 : 2;
  const own = new Set(table.map((row) => row[at]));
  const english = new Set(table.filter((row) => row[0] !== row[at] && !own.has(row[0])).map((row) => row[0]));
  assert.deepEqual(operated.filter((n) => english.has(n.name)).map((n) => n.name), [], `${where}, ${language}: in English`);
}

for (const language of ['en', 'fr', 'pt'] as const) {
  test(`every control has a name and its state in the tree of a screen reader, ${language}`, async () => {
    const word = (english: string) => table.find((row) => row[0] === english)?.[{ en: 0, fr: 1, pt: 2 }[language]] ?? english;
    const page = await openWith(b, site, 'line.g7', { language, view: 'both', bottomOpen: true }, { width: 1440, height: 900 });
    await press(page, 'G1/s/1');
    let nodes = await tree(page);
    wellNamed(nodes, language, 'both views');
    assert.ok(named(nodes, 'button', word('Drawing and text'))?.states.includes('pressed=true'), 'the chosen view is told');
    assert.ok(named(nodes, 'button', word('Drawing'))?.states.includes('pressed=false'), 'and the others');
    await page.getByRole('button', { name: word('One scan'), exact: true }).click();
    for (const panel of ['Variables', 'Inputs and outputs', 'Tests', 'Prove', 'Compare', 'Export', 'Chronogram', 'Problems']) {
      await page.getByRole('tab', { name: word(panel) }).click();
      nodes = await tree(page);
      wellNamed(nodes, language, panel);
      assert.ok(named(nodes, 'tab', word(panel))?.states.includes('selected=true'), `${panel} is told as the open one`);
    }
    await page.getByRole('button', { name: word('Breakpoints'), exact: true }).click();
    assert.ok(named(await tree(page), 'button', word('Breakpoints'))?.states.includes('expanded=true'), 'what is open is told');
    await page.keyboard.press('Escape');
    await page.getByRole('button', { name: word('Settings'), exact: true }).click();
    wellNamed([...nodes, ...(await tree(page))], language, 'settings');
    await page.keyboard.press('Escape');
    await done(page);
  });
}

test('a symbol is named with its state and with what it does, in three languages', async () => {
  for (const [language, scan, expected] of [
    ['en', 'One scan', 'Step 1, active, action N motor'],
    ['fr', 'Un cycle', 'Étape 1, active, action N motor'],
    ['pt', 'Um ciclo', 'Etapa 1, ativa, ação N motor'],
  ] as const) {
    const page = await openWith(b, site, 'line.g7', { language });
    await page.getByRole('button', { name: scan, exact: true }).click();
    await page.getByRole('switch', { name: /go$/ }).first().click();
    await page.getByRole('button', { name: scan, exact: true }).click();
    await press(page, 'G1/s/1');
    const name = () => item(page, 'G1/s/1').getAttribute('aria-label');
    await until(async () => (await name()) === expected, `${expected} is the name`);
    const sheet = page.locator('.sheet');
    assert.equal(await sheet.getAttribute('aria-activedescendant'), await item(page, 'G1/s/1').getAttribute('id'), 'the drawing leads to its selected symbol');
    assert.ok((await tree(page)).some((n) => n.name === expected), 'and the tree has it');
    await done(page);
  }
});

/** Notes each text of the live region, with its time. */
async function listen(page: Opened): Promise<() => Promise<{ at: number; text: string }[]>> {
  await page.evaluate(() => {
    const heard: { at: number; text: string }[] = [];
    Object.assign(window, { heard });
    const region = document.querySelector('[data-speech]') as HTMLElement;
    new MutationObserver(() => heard.push({ at: performance.now(), text: region.textContent ?? '' })).observe(region, { childList: true, characterData: true, subtree: true });
  });
  return () => page.evaluate(() => (window as unknown as { heard: { at: number; text: string }[] }).heard);
}

test('a run tells what changed, with at least a second between two messages', async () => {
  const page = await openWith(b, site, 'clock.g7', {});
  const heard = await listen(page);
  await page.getByRole('button', { name: 'Run', exact: true }).click();
  await until(async () => (await heard()).length >= 5, 'five messages', 40_000);
  const all = await heard();
  const gaps = all.slice(1).map((m, n) => m.at - (all[n]?.at ?? 0));
  assert.ok(gaps.every((ms) => ms >= 1000), `the gaps are ${gaps.map(Math.round).join(', ')} ms`);
  assert.ok(all.every((m) => /active: [01]|[ab] (TRUE|FALSE|0|1)/.test(m.text)), all.map((m) => m.text).join(' | '));
  assert.equal(await page.locator('[data-speech]').getAttribute('aria-live'), 'polite');
  await done(page);
});

test('a new problem is told, and that there is none any more', async () => {
  for (const [language, none] of [
    ['en', 'No problems: this file is ready to run'],
    ['fr', 'Aucun problème : ce fichier est prêt à tourner'],
    ['pt', 'Sem problemas: este ficheiro está pronto a correr'],
  ] as const) {
    const page = await openWith(b, site, 'line.g7', { language });
    const heard = await listen(page);
    await press(page, 'G1/t/0');
    await page.keyboard.press('Enter');
    await page.locator('.inplace > input').fill('absent');
    await page.locator('.inplace > input').press('Enter');
    await until(async () => (await heard()).some((m) => m.text.includes('absent')), 'the problem is told');
    await drawn(page);
    await page.locator('.sheet').focus();
    await page.keyboard.press('Control+z');
    // The proofs may have ended in the same second, and are then told with it.
    await until(async () => (await heard()).at(-1)?.text.split('. ').includes(none) === true, none);
    assert.ok((await heard()).every((m) => !m.text.includes('..')), 'each sentence has one end');
    await done(page);
  }
});

test('nothing moves or blinks for those who asked for less motion', async () => {
  const page = await openWith(b, site, 'clock.g7', { view: 'both', follow: true, bottomOpen: true });
  await page.emulateMedia({ reducedMotion: 'reduce' });
  const moving = () => page.evaluate(() => document.getAnimations().map((a) => `${(a as CSSAnimation).animationName ?? (a as CSSTransition).transitionProperty}`));
  await page.locator('.cm-content').focus();
  await page.waitForFunction(() => document.querySelector('.cm-focused .cm-cursor'));
  assert.deepEqual(await moving(), [], 'the cursor of the text stands');
  await page.getByRole('button', { name: 'Run', exact: true }).click();
  // The mark of a transition that was cleared comes and goes with every frame.
  await page.waitForFunction(() => document.querySelector('.live .flash')?.getAttribute('d'));
  assert.equal(await page.locator('.live .flash').evaluate((e) => getComputedStyle(e).display), 'none', 'no mark blinks');
  await page.getByRole('button', { name: 'Gallery' }).click();
  await page.getByRole('button', { name: /Blank chart/ }).waitFor();
  assert.deepEqual(await moving(), [], 'the cards of the gallery stand');
  await done(page);
});
