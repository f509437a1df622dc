// Stories of the panel *Prove*: what a chart can never do, seen, played and mended.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { axe, browser, cells, done, drawn, inputs, openWith, playground, textOf, until, type Opened, type Site } from './lib';

/** `a` and `b` can open two ways at once; nothing leads to step 4; two scans lead to step 3. */
const FORK = `input a, b, back : BOOL
output M : BOOL
chart G {
  initial step 1
  step 2 { N M }
  step 3
  step 4
  1 -> 2 when a
  1 -> 3 when b
  2 -> 1 when ↑back
  3 -> 1 when ↑back
  4 -> 1 when a
}

prove never X2 and X3
prove reachable M
`;

/** The step behind the first one is reached by an edge, so that a run of it has several scans. */
const LINE = `input go : BOOL
output M : BOOL
chart G {
  initial step 1
  step 2
  step 3 { N M }
  1 -> 2 when ↑go
  2 -> 3 when ↑go
}

prove never M
`;

/** Cells that are free of each other: far more states than a quick search visits. */
const CELLS = 9;
const MANY =
  `input ${inputs(CELLS)} : BOOL\n` +
  cells(CELLS) +
  `prove never ${Array.from({ length: CELLS }, (_, i) => `C${i}.X4`).join(' and ')} and a0 and not a0\n`;

/** The plant gives both inputs; 82 comes 41 scans after the first. */
const TANK = readFileSync(new URL('../../crates/page/tests/tank.g7', import.meta.url), 'utf8');

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'fork.g7': FORK, 'line.g7': LINE, 'many.g7': MANY, 'tank.g7': TANK, 'wrong.g7': FORK.replace('when ↑back', 'when nothing') });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

/** Opens a file with the panel. */
async function prove(file: string, size?: { width: number; height: number }, prefs: object = {}): Promise<Opened> {
  const page = await openWith(b, site, file, { bottomOpen: true, bottom: 300, ...prefs }, size);
  await page.getByRole('tab', { name: /^Prove|^Prouver/ }).click();
  return page;
}

const answer = (page: Page, claim: string) => page.getByRole('listitem').filter({ has: page.getByRole('button', { name: claim, exact: true }) }).first();

/** Waits until a claim has this answer. */
async function is(page: Page, claim: string, verdict: string): Promise<void> {
  await answer(page, claim).getByText(`${verdict}:`, { exact: true }).waitFor({ state: 'attached' });
}

/** The names of the active steps of the run. */
const active = (page: Page) => page.getByRole('status').filter({ hasText: 'Active steps' }).innerText();

const CONFLICT = 'no conflict: no two transitions of one step are clearable at once';

test('every question is answered by itself, the own ones first, and what nothing reaches is pale', async () => {
  const page = await prove('fork.g7');
  await is(page, 'prove never X2 and X3', 'refuted');
  await is(page, 'prove reachable M', 'proved');
  await is(page, 'step 4 can be active', 'refuted');
  await is(page, 'no deadlock', 'proved');
  const claims = await page.locator('.claim').allInnerTexts();
  assert.deepEqual(claims.slice(0, 2), ['prove never X2 and X3', 'prove reachable M']);
  await page.getByText('Everything is answered.').waitFor();
  const dead = () => page.locator('[data-dead]').evaluateAll((all) => all.map((e) => e.getAttribute('data-dead')).sort());
  assert.deepEqual(await dead(), ['G/s/4', 'G/t/4']);
  const fork = () => page.locator('[data-fork="G/s/1"]').count();
  assert.equal(await fork(), 1, 'the conflict is marked where the step diverges');
  await page.getByRole('button', { name: /^Refuted/ }).click();
  assert.equal(await page.locator('.claim').count(), Number((await page.getByRole('button', { name: /^Refuted/ }).innerText()).split(/\s+/).at(-1)));
  await page.getByLabel('Filter').last().fill('step 4');
  assert.deepEqual(await page.locator('.claim').allInnerTexts(), ['step 4 can be active']);
  await answer(page, 'step 4 can be active').getByRole('button', { name: 'step 4 can be active' }).click();
  await page.getByText('no run reaches it').waitFor({ state: 'attached' });
  await page.locator('.sheet').focus();
  await page.keyboard.press('Delete');
  await page.locator('[data-dead]').first().waitFor({ state: 'detached' });
  await page.getByLabel('Filter').last().fill('');
  await until(async () => (await page.locator('.claim').allInnerTexts()).every((c) => !c.includes('4')), 'what is deleted is not asked any more');
  await done(page);
});

test('a refuted answer plays on the chart, and its end is marked', async () => {
  const page = await prove('line.g7');
  await is(page, 'prove never M', 'refuted');
  await page.getByRole('button', { name: 'Play the run on the chart: prove never M' }).click();
  await page.getByText('Run of the proof: prove never M').waitFor();
  await until(async () => /\b3\b/.test(await active(page)), 'the run ends in step 3');
  assert.deepEqual(await page.locator('[data-guilty]').evaluateAll((all) => all.map((e) => e.getAttribute('data-guilty'))), ['G/t/1']);
  await page.getByRole('button', { name: 'One scan back' }).click();
  await until(async () => !/\b3\b/.test(await active(page)), 'one can go back in it');
  await answer(page, 'prove never M').getByRole('button', { name: 'Chronogram' }).click();
  await page.getByRole('button', { name: 'As a table' }).click();
  await until(async () => (await page.getByRole('table').innerText()).includes('go'), 'the chronogram has the inputs of the run');
  await page.getByRole('button', { name: 'End the shown run' }).first().click();
  await page.getByText('Run of the proof: prove never M').waitFor({ state: 'detached' });
  assert.equal(await page.locator('[data-guilty]').count(), 0);
  await done(page);
});

test('a refuted answer is saved as a test that fails, and taken back', async () => {
  const page = await prove('line.g7');
  await is(page, 'prove never M', 'refuted');
  await page.getByRole('button', { name: 'Ways on: prove never M' }).click();
  await page.getByRole('button', { name: 'Save as a test' }).click();
  await page.getByText('undo takes it out').waitFor();
  const text = await textOf(page);
  assert.ok(text.startsWith(LINE) && /\ntest "prove never M" \{[^}]*set go := TRUE[^}]*expect not M\n\}\n$/.test(text), text);
  await page.getByRole('tab', { name: 'Tests' }).click();
  await page.getByRole('button', { name: 'Run all tests' }).click();
  await page.getByText('1 of 1 failed').waitFor();
  await page.getByRole('button', { name: 'Undo', exact: true }).click();
  await until(async () => (await textOf(page)) === LINE, 'one undo takes the test out');
  await done(page);
});

test('a refuted claim about chart and plant is saved as a test with the plant', async () => {
  const page = await prove('tank.g7');
  const claim = 'prove always level <= 80.0 with Tank';
  await is(page, claim, 'refuted');
  await page.getByRole('button', { name: `Ways on: ${claim}` }).click();
  await page.getByRole('button', { name: 'Save as a test' }).click();
  await page.getByText('undo takes it out').waitFor();
  assert.equal(await page.getByRole('button', { name: 'Assume that this cannot happen' }).count(), 0, 'the plant gives the inputs');
  const text = await textOf(page);
  assert.match(text, /test "[^"]*" with Tank \{\n  wait 10\.25s\n  expect level <= 80\.0\n\}/);
  await page.getByRole('tab', { name: 'Tests' }).click();
  await page.getByRole('button', { name: 'Run all tests' }).click();
  await page.getByText('1 of 1 failed').waitFor();
  await done(page);
});

test('what the inputs of the last scan decide is assumed away, and undo takes the assumption back', async () => {
  const page = await prove('line.g7');
  await is(page, 'prove never M', 'refuted');
  await page.getByRole('button', { name: 'Ways on: prove never M' }).click();
  await page.getByText('assume not (X2 and go)').waitFor();
  await page.getByRole('button', { name: 'Assume that this cannot happen' }).click();
  await is(page, 'prove never M', 'proved');
  assert.ok((await textOf(page)).endsWith('prove never M\nassume not (X2 and go)\n'));
  await page.getByRole('button', { name: 'Undo', exact: true }).click();
  await is(page, 'prove never M', 'refuted');
  assert.equal(await textOf(page), LINE);
  await done(page);
});

test('the reason of what is not decided is in the language of the page', async () => {
  const page = await prove('many.g7', undefined, { language: 'fr' });
  await page.getByRole('button', { name: /^Non décidées/ }).click();
  await page.getByText(/aucune exécution de \d+ cycles? au plus n’en décide \(\d+ états visités\) : il y a plus de \d+ états/).first().waitFor();
  await done(page);
});

test('a conflict is cured by one press, and the answers follow', async () => {
  const page = await prove('fork.g7');
  await is(page, CONFLICT, 'refuted');
  const cure = async (name: string, wanted: RegExp) => {
    await page.getByRole('button', { name: `Ways on: ${CONFLICT}` }).click();
    await page.getByRole('button', { name }).click();
    await is(page, CONFLICT, 'proved');
    assert.match(await textOf(page), wanted);
    assert.equal(await page.locator('[data-fork]').count(), 0);
    await page.getByRole('button', { name: 'Undo', exact: true }).click();
    await is(page, CONFLICT, 'refuted');
  };
  await cure('Exclude each other', /1 -> 3 when b and not a\n/);
  await cure('A third, parallel way', /1 -> \(2, 3\) when a and b\n/);
  await cure('Assume that this cannot happen', /\nassume not \(a and b\)\n/);
  await until(async () => (await textOf(page)) === FORK, 'undo gives the text back');
  await done(page);
});

test('a long search goes on beside the work, tells how far it is, and stops', async () => {
  const page = await prove('many.g7');
  await page.getByRole('button', { name: 'Search on' }).waitFor();
  await until(() => page.getByRole('button', { name: 'Search on' }).isEnabled(), 'the quick search has ended');
  await page.getByRole('button', { name: 'Search on' }).click();
  await page.getByText(/Searching: \d+ of \d+ answered/).waitFor();
  await page.getByRole('progressbar', { name: 'Questions answered' }).waitFor();
  const stop = page.getByRole('button', { name: 'Stop', exact: true });
  await page.getByRole('button', { name: 'One scan', exact: true }).click();
  await until(async () => (await active(page)).length > 0, 'the chart runs meanwhile');
  assert.ok(await stop.isVisible(), 'the search goes on meanwhile');
  await stop.click();
  await page.getByRole('button', { name: 'Search on' }).waitFor();
  const never = /^prove never C0.X4/;
  await page.getByRole('listitem').filter({ has: page.getByRole('button', { name: never }) }).getByText('not decided:').waitFor({ state: 'attached' });
  await page.locator('.sheet').focus();
  await page.keyboard.press('Insert');
  await drawn(page);
  assert.ok((await textOf(page)).length > MANY.length, 'gestures are answered');
  await done(page);
});

test('a file with errors says why nothing is asked', async () => {
  const page = await prove('wrong.g7');
  await page.getByText('The file has errors: mend them first').waitFor();
  assert.ok(await page.getByRole('button', { name: 'Search on' }).isDisabled());
  await done(page);
});

test('the panel by keyboard, in French, in the dark, and on a phone', async () => {
  const page = await prove('fork.g7', undefined, { language: 'fr', theme: 'dark' });
  await is(page, 'l’étape 4 peut être active', 'réfuté');
  assert.deepEqual(await axe(page), []);
  const unfold = page.getByRole('button', { name: /^Suites possibles : pas de conflit/ }).or(page.getByRole('button', { name: /^Suites possibles: pas de conflit/ }));
  await unfold.focus();
  await page.keyboard.press('Enter');
  await page.getByRole('button', { name: 'Rendre exclusives' }).waitFor();
  assert.deepEqual(await axe(page), []);
  await page.getByRole('button', { name: /^Jouer l’exécution.*never X2/ }).press('Enter');
  await page.getByText('Exécution de la preuve').waitFor();
  assert.deepEqual(await axe(page), []);
  await done(page);
  const phone = await prove('fork.g7', { width: 390, height: 844 }, { leftOpen: false, rightOpen: false });
  await is(phone, 'prove never X2 and X3', 'refuted');
  assert.deepEqual(await axe(phone), []);
  const claim = await answer(phone, 'prove never X2 and X3').boundingBox();
  assert.ok(claim && claim.x >= 0 && claim.x + claim.width <= 390, 'an answer is as wide as the window');
  await done(phone);
});
