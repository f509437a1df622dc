// Stories of exercises: a student opens one, takes hints, is told what is wrong and when, sees it played, and passes; and what
// of an exercise is in the files of the page.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before, test } from 'node:test';
import { axe, browser, done, openWith, playground, until, type Opened, type Site } from './lib';

const HERE = new URL('..', import.meta.url).pathname;
const DIST = resolve(process.env.G7_DIST ?? join(HERE, 'dist'));
const PRESS = join(HERE, '../exercises/press');
const MODEL = readFileSync(join(PRESS, 'model.g7'), 'utf8');
/** The charts alone: what a student would write. */
const RIGHT = MODEL.slice(0, MODEL.indexOf('plant Slide'));
const ONE_HAND = readFileSync(join(PRESS, 'wrong/one-hand.g7'), 'utf8');
/** A work takes long on a machine that does other things too, in ms. */
const LONG = 120_000;
const FILE = 'loop.g7';
const LOOP = 'chart G1 {\n  initial step 0\n}\n';
/** A picture of the folder with the name of one of an exercise. */
const OTHER = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9"><g data-g7="other"/></svg>';

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ [FILE]: LOOP, 'press.svg': OTHER });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

const panel = (page: Opened) => page.locator('.exercise');
const verdict = (page: Opened, said: RegExp) => panel(page).locator('.result').filter({ hasText: said }).waitFor({ timeout: LONG });
const line = (page: Opened, said: string | RegExp) => panel(page).locator('li').filter({ hasText: said });
const button = (page: Opened, name: string | RegExp) => panel(page).getByRole('button', { name });

/** Opens the gallery and from there the press, with text and drawing side by side. */
async function opened(prefs: object = {}, size?: { width: number; height: number }, words = { gallery: 'Gallery', title: /A press with two-hand control/ }): Promise<Opened> {
  const page = await openWith(b, site, FILE, { view: 'both', ...prefs }, size);
  await page.getByRole('button', { name: words.gallery }).click();
  await page.getByRole('button', { name: words.title }).click();
  await panel(page).getByRole('heading', { name: words.title }).waitFor();
  await page.locator('.sheet [data-id="Press/s/Ready"]').waitFor({ state: 'attached' });
  return page;
}

/** Writes a text in the place of the whole one. */
async function write(page: Opened, text: string, step: string): Promise<void> {
  await page.locator('.cm-content').click();
  await page.keyboard.press('Control+a');
  await page.keyboard.insertText(text);
  await page.locator(`.sheet [data-id="Press/s/${step}"]`).waitFor({ state: 'attached' });
}

async function check(page: Opened, said: RegExp): Promise<void> {
  await button(page, 'Check my solution').click();
  await verdict(page, said);
}

test('the template fails a test that is seen: its moment is told, and played up to there', async () => {
  const page = await opened();
  assert.match(await panel(page).innerText(), /^A press with two-hand control/);
  assert.equal(await panel(page).locator('ol li').count(), 6);
  await check(page, /Not yet\. Tests that fail: \d of 7/);
  // The statement of the test waits 3 s for `bottom`, behind the scan of `set` at the start.
  const failed = line(page, 'both buttons close the press, and it opens again');
  assert.match(await failed.innerText(), /At 3(\.0\d)? s: not true within 3s: bottom/);
  assert.match(await failed.innerText(), /bottom is FALSE/);
  assert.equal(await line(page, 'at rest nothing moves').getByRole('button').count(), 0, 'what passes is not played');
  await failed.getByRole('button', { name: /^Play to this moment/ }).click();
  await page.getByRole('button', { name: /both buttons close the press/ }).and(page.locator('.name')).waitFor();
  // The end of the run is the moment of the test; the buttons are as the test has set them.
  await page.getByRole('status').filter({ hasText: /3\.0\d* s/ }).waitFor();
  assert.equal(await page.getByRole('tab', { name: 'Chronogram', exact: true }).getAttribute('aria-selected'), 'true');
  await page.getByRole('tab', { name: 'Exercise', selected: true }).waitFor();
  await page.getByRole('tab', { name: 'Operate' }).click();
  for (const name of ['left', 'right']) await page.getByRole('switch', { name, exact: true, checked: true }).waitFor();
  await done(page);
});

test('a solution that fits what is seen fails hidden tests, of which no more than the moment is told', async () => {
  const page = await opened();
  await write(page, ONE_HAND, 'Closing');
  await check(page, /All that you see passes\. Hidden tests that fail: [1-5]; hidden questions that are refuted: 1\./);
  await line(page, /Hidden test 1/).filter({ hasText: /It goes wrong at \d/ }).waitFor();
  const told = await panel(page).innerText();
  for (const [, title] of MODEL.matchAll(/^test "(.*)"/gm)) assert.ok(!told.includes(title ?? ''), title);
  assert.ok(!told.includes('down or left'), 'the hidden question');
  assert.equal(await line(page, /^.*Hidden/).getByRole('button').count(), 0, 'a hidden run would show the test');
  await until(async () => /Hidden tests that fail/.test((await page.locator('[data-speech]').textContent()) ?? ''), 'a screen reader is told');
  await done(page);
});

test('a question that is refuted has a run, which is played', async () => {
  const page = await opened();
  await write(page, RIGHT.replace('step Closing {', 'step Closing {\n    N up'), 'Closing');
  await check(page, /Not yet\./);
  const refuted = line(page, 'never down and up');
  await refuted.getByRole('button', { name: /^Play to this moment/ }).click();
  await page.getByRole('button', { name: /never down and up/ }).and(page.locator('.name')).waitFor();
  await page.getByRole('status').filter({ hasText: /Closing/ }).waitFor();
  await done(page);
});

test('a locked part that was changed, a name that is missing and an error are told with their places', async () => {
  const page = await opened();
  await write(page, RIGHT.replace('output down, up : BOOL', 'output down, up : BOOL := FALSE'), 'Closing');
  await check(page, /a locked part is changed/);
  const changed = line(page, /the locked part down is not as in the template/);
  await changed.getByRole('button', { name: 'Show in the text' }).click();
  await page.locator('.cm-activeLine').filter({ hasText: 'output down, up' }).waitFor();

  await write(page, RIGHT.replaceAll('down', 'dawn'), 'Closing');
  await check(page, /Not yet\./);
  await line(page, /the exercise looks at down, which is not there; there is dawn at press\.g7:/).waitFor();

  await write(page, RIGHT.replace('when top', 'when nothing'), 'Closing');
  await check(page, /The chart has errors/);
  await line(page, /nothing/).getByRole('button', { name: 'Show in the text' }).click();
  await page.locator('.cm-activeLine').filter({ hasText: 'when nothing' }).waitFor();
  await done(page);
});

test('a right solution passes, and that stays when the page is loaded again, with its text and hints', async () => {
  const page = await opened();
  await button(page, /^Next hint \(1 of 3\)/).click();
  await panel(page).getByRole('heading', { name: 'Which situations are there?' }).waitFor();
  await button(page, /^Next hint \(2 of 3\)/).waitFor();
  await write(page, RIGHT, 'LetGo');
  await check(page, /All is right: 7 tests pass\./);
  await panel(page).locator('.chip', { hasText: 'done' }).waitFor();
  // Unsaved work and progress are kept a moment later.
  await page.waitForFunction(() => Object.entries(localStorage).filter(([key, text]) => /^g7-(work|exercises)/.test(key) && text.includes('step LetGo')).length === 2);
  await page.reload();
  await page.getByRole('tab', { name: 'press.g7' }).click();
  await page.locator('.sheet [data-id="Press/s/LetGo"]').waitFor({ state: 'attached' });
  await page.getByRole('tab', { name: 'Exercise' }).click();
  await panel(page).locator('.chip', { hasText: 'done' }).waitFor();
  await panel(page).getByRole('heading', { name: 'Which situations are there?' }).waitFor();
  await button(page, /^Next hint \(2 of 3\)/).waitFor();
  await page.getByRole('button', { name: 'Gallery' }).click();
  await page.getByRole('button', { name: /A press with two-hand control/ }).filter({ hasText: 'done' }).waitFor();
  await page.getByRole('button', { name: /traffic light/ }).filter({ hasText: 'not begun' }).waitFor();
  await done(page);
});

test('a plant has the picture of its exercise, whatever the folder has under that name, and after loading again', async () => {
  const page = await opened();
  const seen = async () => {
    await page.getByRole('tab', { name: 'Operate' }).click();
    await page.getByRole('button', { name: 'Run', exact: true }).first().click();
    await page.locator('.picture svg [data-g7="slide"]').waitFor({ state: 'attached' });
    assert.equal(await page.locator('.picture svg [data-g7="other"]').count(), 0);
  };
  await seen();
  // A button of the picture works.
  await page.locator('.picture svg').getByRole('button', { name: /\(left\)/ }).click();
  await page.locator('.picture svg [aria-pressed="true"]').filter({ hasText: 'left' }).waitFor();
  await page.reload();
  await page.getByRole('button', { name: 'Gallery' }).click();
  await page.getByRole('button', { name: /A press with two-hand control/ }).click();
  await page.locator('.sheet [data-id="Press/s/Ready"]').waitFor({ state: 'attached' });
  await seen();
  await done(page);
});

test('each picture of an exercise has what its plant moves, and shows nothing else than the signals of the exercise', () => {
  const all = JSON.parse(readFileSync(join(DIST, 'exercises.json'), 'utf8')) as { id: string; pictures: Record<string, string>; given: { template: string } | null }[];
  for (const { id, pictures, given } of all) {
    assert.ok(given, id);
    const view = /\n  view '(.*)' \{\n([^}]*)\}/.exec(given.template);
    assert.ok(view, `${id} has a picture`);
    const [, name = '', bound = ''] = view;
    const picture = pictures[name] ?? '';
    const elements = new Set([...picture.matchAll(/data-g7="(\w+)"/g)].map(([, element]) => element));
    const moved = new Set([...bound.matchAll(/^ *(\w+)\.\w+ := /gm)].map(([, element]) => element));
    assert.deepEqual([...moved].sort(), [...elements].sort(), `${id}: ${name}`);
    for (const [, signal = ''] of picture.matchAll(/data-g7-(?:press|click)="(\w+)"/g)) assert.match(given.template, new RegExp(`\\b${signal}\\b`), `${id}: ${signal}`);
  }
});

test('the template comes back after a question, and the text of before can be had back', async () => {
  const page = await opened();
  await write(page, RIGHT, 'LetGo');
  await button(page, 'Start again').click();
  await button(page, 'Cancel').click();
  await page.locator('.sheet [data-id="Press/s/LetGo"]').waitFor({ state: 'attached' });
  await button(page, 'Start again').click();
  await button(page, 'Bring the template back').click();
  await page.locator('.sheet [data-id="Press/s/LetGo"]').waitFor({ state: 'detached' });
  await page.locator('.cm-content').getByText('// Your chart:').waitFor();
  await page.getByRole('button', { name: 'Gallery' }).click();
  await page.getByRole('button', { name: /^Unsaved work/ }).click();
  await page.getByRole('dialog').locator('li', { hasText: 'press.g7' }).getByRole('button', { name: 'Restore' }).click();
  await page.locator('.sheet [data-id="Press/s/LetGo"]').waitFor({ state: 'attached' });
  await done(page);
});

test('an exercise speaks three languages, on a telephone too, and can be heard', async () => {
  const page = await opened({ language: 'fr', view: 'chart' }, { width: 390, height: 780 }, { gallery: 'Galerie', title: /Une presse à commande bimanuelle/ });
  await button(page, 'Vérifier ma solution').click();
  await verdict(page, /Pas encore\. Essais en échec/);
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
  assert.deepEqual(await axe(page), []);
  await done(page);

  const other = await opened({ language: 'pt' }, undefined, { gallery: 'Galeria', title: /Uma prensa com comando bimanual/ });
  await button(other, /^Pista seguinte \(1 de 3\)/).click();
  await button(other, 'Verificar a minha solução').click();
  await verdict(other, /Ainda não\. Testes que falham/);
  assert.deepEqual(await axe(other), []);
  await done(other);
});

test('an exercise with mistakes is told to its teacher, and the others open', async () => {
  const page = await openWith(b, site, FILE, {});
  const all = JSON.parse(readFileSync(join(DIST, 'exercises.json'), 'utf8')) as object[];
  const broken = { id: 'broken', texts: [], given: null, faults: [{ place: 'broken/model.g7', what: 'there is none' }] };
  await page.route('**/exercises.json', (route) => route.fulfill({ json: [broken, ...all] }));
  await page.getByRole('button', { name: 'Gallery' }).click();
  await page.getByText('broken/model.g7: there is none').waitFor();
  await page.getByRole('button', { name: /A press with two-hand control/ }).click();
  await panel(page).getByRole('heading', { name: /A press/ }).waitFor();
  await done(page);
});

test('a check shows that it works, is cancelled, and can be asked for again', async () => {
  const page = await opened();
  let release = (): void => undefined;
  const held = new Promise<void>((done) => (release = done));
  // The check cannot end before its module has come.
  await page.route('**/g7-whole.wasm', (route) => held.then(() => route.continue()).catch(() => undefined));
  await button(page, 'Check my solution').click();
  await panel(page).getByRole('progressbar', { name: 'Check my solution' }).waitFor();
  await button(page, 'Cancel').click();
  await button(page, 'Check my solution').waitFor();
  assert.equal(await panel(page).locator('.result').count(), 0);
  release();
  await check(page, /Not yet\./);
  await done(page);
});

test('a damaged hidden part is a sentence, and the page goes on', async () => {
  const page = await openWith(b, site, FILE, { view: 'both' });
  const all = readFileSync(join(DIST, 'exercises.json'), 'utf8').replace(/"sealed":"../g, '"sealed":"zz');
  await page.route('**/exercises.json', (route) => route.fulfill({ json: JSON.parse(all) as object }));
  await page.getByRole('button', { name: 'Gallery' }).click();
  await page.getByRole('button', { name: /A press with two-hand control/ }).click();
  await button(page, 'Check my solution').click();
  await panel(page).getByText('the hidden part of this exercise is damaged').waitFor({ timeout: LONG });
  await button(page, 'Check my solution').waitFor();
  await done(page);
});

test('a folder with a mistake is told with its place when the page is built, and the others are made', () => {
  const folder = mkdtempSync(join(tmpdir(), 'g7-exercises-'));
  try {
    for (const id of ['bare', 'half', 'press']) cpSync(PRESS, join(folder, id), { recursive: true });
    rmSync(join(folder, 'bare/press.svg'));
    rmSync(join(folder, 'half/model.g7'));
    writeFileSync(join(folder, 'half/hints.fr.md'), '## Un seul\n');
    const out = join(folder, 'out.json');
    const ran = spawnSync(process.execPath, [join(HERE, 'exercises.mjs'), join(DIST, 'g7-whole.wasm'), folder, out], { encoding: 'utf8' });
    assert.equal(ran.status, 0, ran.stderr);
    assert.match(ran.stderr, /half\/model\.g7: error: an exercise has a file with this name: the model solution/);
    assert.match(ran.stderr, /bare\/template\.g7: error: the picture press\.svg is not in the folder/);
    assert.match(ran.stderr, /half\/hints\.fr\.md: error: hints here: 1; in English: 3/);
    const made = JSON.parse(readFileSync(out, 'utf8')) as { id: string; given: { template: string } | null; faults: object[]; texts: { title: string }[] }[];
    assert.deepEqual(made.map((one) => [one.id, one.given !== null, one.faults.length]), [['press', true, 0], ['bare', true, 1], ['half', false, 2]]);
    assert.deepEqual(made[0]?.texts.map((one) => one.title), ['A press with two-hand control', 'Une presse à commande bimanuelle', 'Uma prensa com comando bimanual']);
    assert.equal(made[0]?.given?.template, readFileSync(join(PRESS, 'template.g7'), 'utf8'));
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
});

test('no text of a hidden test or of a solution can be read in the files of the page', () => {
  const folder = join(HERE, '../exercises');
  const secret: string[] = [];
  const ids = readdirSync(folder, { withFileTypes: true }).filter((entry) => entry.isDirectory()).map((entry) => entry.name);
  // A template of the laboratory gives what was asked before it, so what any of them shows is no secret.
  const given = ids.map((id) => readFileSync(join(folder, id, 'template.g7'), 'utf8'));
  const shows = (line: string) => given.some((template) => template.includes(line));
  for (const id of ids) {
    const text = (name: string) => readFileSync(join(folder, id, name), 'utf8');
    const template = text('template.g7');
    for (const [title] of text('model.g7').matchAll(/^test ".*"/gm)) assert.ok(template.includes(title) || !shows(title), `${id}: another template shows ${title}`);
    const solutions = ['model.g7', ...readdirSync(join(folder, id, 'wrong')).map((name) => `wrong/${name}`)];
    // Lines of declarations are in the template, and short ones in many files.
    const lines = solutions.flatMap((name) => text(name).split('\n').map((l) => l.trim()));
    secret.push(...lines.filter((l) => /^(test|prove|step|wait|set|expect|[\w(), ]+ -> )/.test(l) && l.length >= 24 && !shows(l)));
  }
  assert.ok(secret.length > 40, `${secret.length}`);
  const files = readdirSync(DIST, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
  assert.ok(files.some((entry) => entry.name === 'exercises.json'));
  for (const entry of files) {
    const bytes = readFileSync(join(entry.parentPath, entry.name));
    // Texts in JSON have their marks of quotation with a stroke before them.
    const text = bytes.toString('latin1').replaceAll('\\"', '"');
    for (const line of secret) assert.ok(!text.includes(Buffer.from(line).toString('latin1')), `${entry.name}: ${line}`);
  }
});
