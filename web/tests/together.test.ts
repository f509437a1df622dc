// Stories of several people at one file: what one changes all have, each undoes what is theirs, and guests look.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, afterEach, before, beforeEach, test } from 'node:test';
import type { Page } from 'playwright-core';
import { axe, browser, core, done, openWith, press, serve, until, type Opened, type Site } from './lib';

const TEXT = `input a : BOOL
output M : BOOL
chart G1 {
  initial step 0
  step 1 { N M }
  0 -> 1 when a
  1 -> 0 when not a
}
`;

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;
let folder: string;

before(async () => {
  b = await browser();
});

after(async () => {
  await b?.done();
});

beforeEach(async () => {
  folder = mkdtempSync(join(tmpdir(), 'g7-together-'));
  writeFileSync(join(folder, 'loop.g7'), TEXT);
  site = await serve(folder, '--guests');
});

afterEach(async () => {
  await site.stop();
  rmSync(folder, { recursive: true, force: true });
});

const disk = () => readFileSync(join(folder, 'loop.g7'), 'utf8');
const dirty = (page: Page) => page.locator('[role=tab] .dot');
const notice = (page: Page, text: string) => page.locator('.notice').getByText(text).first();

/** The text of a page, without the names of others in it. */
const text = (page: Page) =>
  page.locator('.cm-content').evaluate((content) => {
    const copy = content.cloneNode(true) as HTMLElement;
    copy.querySelectorAll('.cm-person').forEach((person) => person.remove());
    return [...copy.querySelectorAll('.cm-line')].map((line) => line.textContent).join('\n');
  });

/** Types at the begin or at the end of the text. */
async function type(page: Page, key: 'Control+Home' | 'Control+End', words: string, delay = 0): Promise<void> {
  await page.locator('.cm-content').click();
  await page.keyboard.press(key);
  await page.keyboard.type(words, { delay });
}

/** A page of somebody who has joined the others at the file, beside its text. */
async function joined(name: string): Promise<Opened> {
  const page = await openWith(b, site, 'loop.g7', { view: 'both' });
  await joinAs(page, name);
  return page;
}

async function joinAs(page: Page, name: string): Promise<void> {
  await page.getByRole('button', { name: 'Work together' }).click();
  await page.getByLabel('Your name').fill(name);
  await page.getByRole('button', { name: 'Work on it together' }).last().click();
  await page.getByText(`${name} (you)`).waitFor();
  await page.keyboard.press('Escape');
}

/** Both pages have one text, and it has these words, each of them once. */
async function agree(pages: Page[], ...words: string[]): Promise<string> {
  const all = () => Promise.all(pages.map(text));
  await until(async () => {
    const texts = await all();
    return texts.every((of) => of === texts[0] && words.every((word) => of.split(word).length === 2));
  }, 'the texts differ').catch(async (error: Error) => assert.fail(`${error.message}:\n${(await all()).join('\n----\n')}`));
  return (await all())[0] ?? '';
}

test('what one types or draws, the other has; each undoes what is theirs', async () => {
  const ana = await joined('Ana');
  const ben = await joined('Ben Carter');
  await ana.getByRole('button', { name: 'People at this file: Ben Carter' }).getByText('BC').waitFor();
  await type(ana, 'Control+Home', '// by Ana\n');
  await agree([ana, ben], '// by Ana');
  await press(ben, 'G1/s/1');
  await ben.keyboard.press('Tab');
  await ben.locator('.inplace > input').waitFor();
  await ben.keyboard.press('Escape');
  await ana.locator('[data-id="G1/s/2"]').waitFor({ state: 'attached' });
  await agree([ana, ben], 'step 2');

  // A word is undone at a time.
  for (let n = 0; n < 6; n++) await ana.keyboard.press('Control+z');
  await until(async () => !(await text(ana)).includes('//'), 'it is not undone');
  assert.match(await agree([ana, ben], 'step 2'), /^input a/);
  await ben.getByRole('button', { name: 'Undo' }).click();
  await until(async () => !(await text(ben)).includes('step 2'), 'it is not undone');
  assert.equal(await agree([ana, ben]), TEXT);
  assert.equal(disk(), TEXT);
  assert.deepEqual(await axe(ben), []);
  await Promise.all([done(ana), done(ben)]);
});

test('who types at the same time loses nothing', async () => {
  const people = [await joined('Ana'), await joined('Ben'), await joined('Eva')];
  const words = ['// the first line of Ana\n', '// the first line of Ben\n', '// the last line of Eva'];
  const at = ['Control+Home', 'Control+Home', 'Control+End'] as const;
  await Promise.all(people.map((page, n) => type(page, at[n] ?? 'Control+End', words[n] ?? '', 15)));
  const now = await agree(people);
  // Letters of two people who type at one place may be mixed; none is lost, and the chart is what it was.
  const letters = (of: string) => [...of].sort().join('');
  assert.equal(letters(now), letters(TEXT + words.join('')));
  assert.ok(now.includes(TEXT.trim()) && now.endsWith('// the last line of Eva'), now);
  await Promise.all(people.map(done));
});

test('what one saves is saved for all, and a file that another program writes is taken over once', async () => {
  const ana = await joined('Ana');
  const ben = await joined('Ben');
  await type(ana, 'Control+Home', '// one\n');
  await agree([ana, ben], '// one');
  await dirty(ben).waitFor();
  await ana.keyboard.press('Control+s');
  await until(() => Promise.resolve(disk() === `// one\n${TEXT}`), 'it is not saved');
  await Promise.all([ana, ben].map((page) => dirty(page).waitFor({ state: 'detached' })));

  await type(ben, 'Control+Home', '// two\n');
  await ben.keyboard.press('Control+s');
  await until(() => Promise.resolve(disk() === `// two\n// one\n${TEXT}`), 'it is not saved');
  await Promise.all([ana, ben].map((page) => dirty(page).waitFor({ state: 'detached' })));

  writeFileSync(join(folder, 'loop.g7'), `// theirs\n${disk()}`);
  await agree([ana, ben], '// theirs', '// two', '// one');
  await Promise.all([ana, ben].map((page) => dirty(page).waitFor({ state: 'detached' })));
  assert.equal(await ana.getByRole('alert').filter({ hasText: 'changed outside' }).count(), 0);
  await Promise.all([done(ana), done(ben)]);
});

test('who joins with changes has the text of the others, and the changes can be had back', async () => {
  const ana = await joined('Ana');
  await type(ana, 'Control+Home', '// by Ana\n');
  const ben = await openWith(b, site, 'loop.g7', { view: 'both' });
  await ben.getByRole('status').getByText('Ana has loop.g7 open to work on it together.').waitFor();
  // Nothing is shared before a person says so.
  assert.equal(await text(ben), TEXT);
  await type(ben, 'Control+Home', '// by Ben\n');
  assert.ok(!(await text(ana)).includes('by Ben'));
  await joinAs(ben, 'Ben');
  await notice(ben, 'Your changes are in “Unsaved work”').waitFor();
  const now = await agree([ana, ben], '// by Ana');
  assert.ok(!now.includes('by Ben'));
  await ben.getByRole('button', { name: 'Unsaved work' }).click();
  await ben.getByRole('dialog').getByText('loop.g7').first().waitFor();
  await ben.keyboard.press('Escape');

  // Who leaves goes on with a copy.
  await ben.getByRole('button', { name: 'Work together' }).click();
  await ben.getByRole('button', { name: 'Leave the others' }).click();
  await ben.keyboard.press('Escape');
  await notice(ana, 'Ben has left').waitFor();
  await type(ben, 'Control+Home', '// alone\n');
  await type(ana, 'Control+Home', '// more\n');
  assert.ok(!(await text(ben)).includes('more') && !(await text(ana)).includes('alone'));
  await Promise.all([done(ana), done(ben)]);
});

test('everyone sees where the others are: in the drawing and in the text', async () => {
  const ana = await joined('Ana');
  const ben = await joined('Ben');
  await ben.mouse.move(...(await core(ben, 'G1/s/0')));
  await press(ben, 'G1/s/1');
  const person = ana.locator('.person[data-person="Ben"]');
  await person.locator('rect').waitFor({ state: 'attached' });
  await person.getByText('Ben').waitFor({ state: 'attached' });
  // The frame of the selection lies round the step, and the pointer where it is in the other page.
  const [frame, step] = await Promise.all([person.locator('rect').boundingBox(), ana.locator('[data-id="G1/s/1"] .g7-box').first().boundingBox()]);
  assert.ok(frame && step && frame.x < step.x && frame.y < step.y && frame.x + frame.width > step.x + step.width, JSON.stringify([frame, step]));

  await ben.locator('.cm-line').nth(3).click();
  const caret = ana.locator('.cm-line').nth(3).locator('.cm-person');
  await caret.getByText('Ben').waitFor({ state: 'attached' });
  await type(ana, 'Control+Home', '// more\n');
  await ana.locator('.cm-line').nth(4).locator('.cm-person').waitFor({ state: 'attached' });
  await ben.context().close();
  await person.waitFor({ state: 'detached' });
  await ana.locator('.cm-person').waitFor({ state: 'detached' });
  await done(ana);
});

test('after a server that ended all go on together, with what each did meanwhile', async () => {
  const ana = await joined('Ana');
  const ben = await joined('Ben');
  await type(ana, 'Control+Home', '// before\n');
  await agree([ana, ben], '// before');
  const port = new URL(site.url).port;
  await site.crash?.();
  const banner = (page: Page) => page.getByRole('status').getByText('Your work is kept in this browser');
  await Promise.all([banner(ana).waitFor(), banner(ben).waitFor()]);
  await type(ana, 'Control+Home', '// Ana alone\n');
  await type(ben, 'Control+End', '// Ben alone');
  site = await serve(folder, '--guests', '--port', port);
  await Promise.all([banner(ana), banner(ben)].map((of) => of.waitFor({ state: 'detached' })));
  await agree([ana, ben], '// before', '// Ana alone', '// Ben alone');
  await type(ben, 'Control+Home', '// and on\n');
  await agree([ana, ben], '// and on', '// before', '// Ana alone', '// Ben alone');
  await Promise.all([ana, ben].map((page) => page.context().close()));
});

test('a change whose answer was lost is made once', async () => {
  const ana = await joined('Ana');
  const ben = await openWith(b, site, 'loop.g7', { view: 'both' });
  // The first change reaches the server, and the connection breaks before its answer has come.
  let breaks = true;
  await ben.routeWebSocket(/api\/live/, (socket) => {
    const there = socket.connectToServer();
    let dumb = false;
    socket.onMessage((message) => {
      there.send(message);
      if (!breaks || !String(message).includes('together_change')) return;
      breaks = false;
      dumb = true;
      setTimeout(() => void socket.close(), 300);
    });
    there.onMessage((message) => (dumb ? undefined : socket.send(message)));
  });
  await ben.reload();
  await joinAs(ben, 'Ben');
  await type(ben, 'Control+Home', 'x');
  await agree([ana], 'xinput');
  await type(ana, 'Control+End', '// by Ana');
  await until(() => Promise.resolve(!breaks), 'the connection did not break');
  await type(ben, 'Control+Home', 'y');
  const now = await agree([ana, ben], '// by Ana', 'yxinput');
  assert.equal(now, `yx${TEXT}// by Ana`);
  await Promise.all([ana, ben].map((page) => page.context().close()));
});

test('a guest looks, and has a copy to try things', async () => {
  const ana = await joined('Ana');
  await ana.getByRole('button', { name: 'Work together' }).click();
  await ana.getByAltText('QR code of the address for guests').waitFor();
  const address = await ana.getByLabel('Address for guests').inputValue();
  assert.deepEqual(await axe(ana), []);
  await ana.keyboard.press('Escape');
  const gil = await openWith(b, { ...site, url: address }, 'loop.g7', { view: 'both', language: 'fr' });
  await gil.getByText('Invité', { exact: true }).waitFor();
  await gil.getByRole('status').getByText('Ana a ouvert loop.g7').waitFor();
  // A copy of one's own can be changed, and is saved as a download.
  await type(gil, 'Control+Home', '// essai\n');
  const [download] = await Promise.all([gil.waitForEvent('download'), gil.keyboard.press('Control+s')]);
  assert.equal(download.suggestedFilename(), 'loop.g7');
  assert.equal(disk(), TEXT);
  await gil.getByRole('button', { name: 'Regarder' }).click();
  await gil.getByLabel('Votre nom').fill('Gil');
  await gil.getByRole('dialog').getByRole('button', { name: 'Regarder' }).click();
  await gil.getByText('Gil (vous)').waitFor();
  assert.deepEqual(await axe(gil), []);
  await gil.keyboard.press('Escape');
  await notice(ana, 'Gil has joined').waitFor();
  await type(ana, 'Control+Home', '// by Ana\n');
  await agree([ana, gil], '// by Ana');
  // Neither the text nor the drawing can be changed while looking.
  await type(gil, 'Control+Home', 'nothing');
  await press(gil, 'G1/s/1');
  await gil.keyboard.press('Delete');
  await notice(gil, 'Vous regardez le travail des autres').waitFor();
  assert.ok(!(await text(gil)).includes('nothing') && (await text(gil)).includes('step 1'));
  await gil.getByRole('button', { name: 'Cesser de regarder' }).click();
  await type(gil, 'Control+Home', '// de nouveau\n');
  await until(async () => (await text(gil)).startsWith('// de nouveau'), 'the copy cannot be changed');
  assert.ok(!(await text(ana)).includes('de nouveau'));
  await Promise.all([done(ana), done(gil)]);
});
