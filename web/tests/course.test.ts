// The course beside the editor: its chapters are whole in three languages, their charts open and keep what a reader makes of
// them, a question tells right from wrong, and the browser remembers the answers.
import assert from 'node:assert/strict';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { axe, browser, done, drawn, openWith, playground, press, until, type Opened, type Site } from './lib';
import { lesson } from '../src/course/lesson';
import { course as words } from '../src/lib/words/course';
import { exercise as told } from '../src/lib/words/exercise';
import { run } from '../src/lib/words/run';

const ROOT = join(import.meta.dirname, '../..');
const ENDINGS = { en: 'text.md', fr: 'text.fr.md', pt: 'text.pt.md' } as const;
const AT = { en: 0, fr: 1, pt: 2 } as const;

let b: Awaited<ReturnType<typeof browser>>;
/** A playground without examples: the course brings its own. */
let site: Site;

before(async () => {
  [site, b] = await Promise.all([playground({}), browser()]);
});

after(async () => {
  await b?.done();
  await site?.stop();
});

const chapters = readdirSync(join(ROOT, 'course'), { withFileTypes: true })
  .filter((e) => e.isDirectory())
  .map((e) => e.name)
  .sort();

const textOf = (id: string, language: keyof typeof ENDINGS) => readFileSync(join(ROOT, 'course', id, ENDINGS[language]), 'utf8');
const titleOf = (id: string, language: keyof typeof ENDINGS) => /^# (.*)/.exec(textOf(id, language))?.[1] ?? '';

test('each chapter says the same in three languages, and names only what there is', () => {
  assert.ok(chapters.length >= 15, chapters.join(', '));
  for (const id of chapters) {
    const [en, fr, pt] = (['en', 'fr', 'pt'] as const).map((language) => {
      const blocks = lesson(textOf(id, language));
      assert.equal(blocks.filter((k) => k.is === 'question').length, 1, `${id} has one question, ${language}`);
      return blocks.map((k) => {
        if (k.is === 'chart') return `chart ${k.href}`;
        if (k.is === 'exercises') return `exercises ${k.list.map((one) => one.name).join(' ')}`;
        if (k.is === 'question') return `question ${k.choices.map((c) => (c.right ? 'right' : c.why.length > 0 ? 'wrong' : 'no reason')).join(' ')}`;
        return k.token.type === 'list' ? `list of ${(k.token as unknown as { items: unknown[] }).items.length}` : k.token.type;
      });
    });
    assert.deepEqual(fr, en, `${id}, French`);
    assert.deepEqual(pt, en, `${id}, Portuguese`);
    const rows = en ?? [];
    const [question = ''] = rows.filter((row) => row.startsWith('question'));
    assert.equal(question.split('right').length, 2, `${id}: ${question}`);
    assert.ok(!question.includes('no reason'), `${id}: ${question}`);
    assert.ok(rows.some((row) => row.startsWith('chart')), `${id} shows a chart`);
    for (const row of rows) {
      const [kind, ...names] = row.split(' ');
      const [name = ''] = names;
      if (kind === 'chart') assert.ok(existsSync(join(ROOT, 'course', id, name)), `${id}: ${name}`);
      if (kind === 'exercises') for (const one of names) assert.ok(existsSync(join(ROOT, 'exercises', one, 'statement.md')), `${id}: ${one}`);
    }
  }
});

const chapter = (page: Page, title: string) => page.getByRole('button', { name: new RegExp(`^\\d+ ${title}`) });
const article = (page: Page) => page.locator('article');

async function start(language: keyof typeof AT, size?: { width: number; height: number }, prefs: object = {}): Promise<Opened> {
  const page = await openWith(b, site, '', { language, ...prefs }, size);
  await page.getByRole('heading', { name: words['course.title'][AT[language]], exact: true }).waitFor();
  return page;
}

test('a chapter is read in each language, with its chart beside it', async () => {
  for (const language of ['en', 'fr', 'pt'] as const) {
    const page = await start(language);
    assert.equal(await page.locator('section[aria-labelledby="start-course"] li').count(), chapters.length);
    const title = titleOf('02-rules', language);
    await chapter(page, title).click();
    await article(page).getByRole('heading', { name: title }).waitFor();
    await drawn(page);
    assert.equal(await page.locator('.sheet [data-id="Rules/s/4"]').count(), 1, 'the first chart of the chapter is open');
    await page.locator('figure svg').first().waitFor();
    assert.deepEqual(await axe(page), [], language);
    await done(page);
  }
});

test('an answer is told right or wrong with its reason, and stays answered', async () => {
  const page = await start('en');
  await chapter(page, titleOf('01-first', 'en')).click();
  const answers = page.getByRole('radiogroup');
  await answers.getByText('The chart is in error', { exact: true }).click();
  await answers.getByText('a receptivity may be true at any time').waitFor();
  await until(async () => (await page.locator('[data-speech]').textContent())?.includes('No') === true, 'a wrong answer is told');
  assert.equal(await page.getByRole('combobox', { name: 'Chapter' }).locator('option').first().textContent(), '1. What a GRAFCET is');
  await answers.getByText('Nothing', { exact: true }).click();
  await answers.getByText('step 1 is not active').waitFor();
  await until(async () => (await page.locator('[data-speech]').textContent())?.includes('Right') === true, 'a right answer is told');
  await page.getByRole('button', { name: /^Next chapter: / }).click();
  await article(page).getByRole('heading', { name: titleOf('02-rules', 'en') }).waitFor();
  await page.getByRole('button', { name: 'Gallery' }).click();
  await page.getByRole('button', { name: 'Go on with chapter 2' }).waitFor();
  await page.reload();
  await page.getByRole('button', { name: 'Gallery' }).click();
  await page.getByRole('button', { name: 'Go on with chapter 2' }).waitFor();
  await page.getByRole('button', { name: '1 What a GRAFCET is answered' }).waitFor();
  await done(page);
});

test('a chart that the reader changed is shown again as it is, and a plant has its picture', async () => {
  const page = await start('en');
  await chapter(page, titleOf('07-times', 'en')).click();
  await drawn(page);
  assert.ok((await page.locator('[role=tab]').allTextContents()).join(' ').includes('bottle-conveyor'), 'an example keeps its name');
  await press(page, 'Conveyor/s/0');
  await page.keyboard.press('Delete');
  await until(async () => (await page.locator('.sheet [data-id="Conveyor/s/0"]').count()) === 0, 'the step is gone');
  await page.getByRole('button', { name: 'Open in the editor Counters and timers' }).click();
  await page.locator('.sheet [data-id^="Conveyor/"]').first().waitFor({ state: 'detached' });
  await page.getByRole('button', { name: 'Open in the editor A conveyor that stops after five bottles' }).click();
  await page.locator('.sheet [data-id="Conveyor/s/1"]').waitFor({ state: 'attached' });
  assert.equal(await page.locator('.sheet [data-id="Conveyor/s/0"]').count(), 0, 'it is as the reader left it');
  await page.keyboard.press('Control+z');
  await page.locator('.sheet [data-id="Conveyor/s/0"]').waitFor({ state: 'attached' });
  await page.getByRole('tab', { name: 'Operate' }).click();
  await page.getByRole('button', { name: 'Run', exact: true }).first().click();
  await page.locator('.picture svg [data-g7]').first().waitFor({ state: 'attached' });
  await page.getByRole('button', { name: 'Close the course' }).click();
  await article(page).waitFor({ state: 'detached' });
  await page.getByRole('button', { name: 'Course', exact: true }).click();
  await article(page).getByRole('heading', { name: titleOf('07-times', 'en') }).waitFor();
  await done(page);
});

test('the laboratory is done from its chapter: a template is not done yet, a solution passes, and the unit has its picture', async () => {
  const model = readFileSync(join(ROOT, 'exercises/bead-sorter-2-rest/model.g7'), 'utf8');
  for (const language of ['en', 'fr'] as const) {
    const page = await start(language, { width: 1600, height: 900 }, { view: 'both' });
    await chapter(page, titleOf('14-bead-sorter', language)).click();
    const tasks = article(page).locator('li .task');
    const folders = readdirSync(join(ROOT, 'exercises')).filter((name) => name.startsWith('bead-sorter')).sort();
    await tasks.first().waitFor();
    assert.equal(await tasks.count(), folders.length, 'the whole laboratory');
    const rest = tasks.nth(folders.indexOf('bead-sorter-2-rest'));
    await rest.getByRole('button').click();
    const panel = page.locator('.exercise');
    const sorter = page.locator('.sheet [data-id="Sorter/s/Sequenced"]');
    await sorter.waitFor({ state: 'attached' });
    const check = async (said: readonly string[]) => {
      await panel.getByRole('button', { name: told['exercise.check'][AT[language]] }).click();
      await panel.locator('.result').filter({ hasText: (said[AT[language]] ?? '').split(/[.:]/)[0] }).waitFor({ timeout: 120_000 });
    };
    await check(told['exercise.failed']);
    await rest.getByText(told['exercise.begun'][AT[language]]).waitFor();
    await page.locator('.cm-content').click();
    await page.keyboard.press('Control+a');
    await page.keyboard.insertText(model);
    await sorter.waitFor({ state: 'attached' });
    await check(told['exercise.passed']);
    await rest.getByText(told['exercise.done'][AT[language]]).waitFor();
    // The model has no plant; that of the template comes back with it.
    await panel.getByRole('button', { name: told['exercise.again'][AT[language]] }).click();
    await panel.getByRole('button', { name: told['exercise.reallyAgain'][AT[language]] }).click();
    await page.getByRole('tab', { name: run['run.panel'][AT[language]] }).click();
    await page.getByRole('button', { name: run['run.play'][AT[language]], exact: true }).first().click();
    await page.locator('.picture svg [data-g7="unit"]').waitFor({ state: 'attached' });
    assert.deepEqual(await axe(page), [], language);
    await done(page);
  }
});

test('on a telephone the text and the chart take turns', async () => {
  const page = await start('pt', { width: 390, height: 844 });
  await chapter(page, titleOf('05-and', 'pt')).click();
  await article(page).getByRole('heading', { name: titleOf('05-and', 'pt') }).waitFor();
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing is wider than the window');
  await page.locator('figure button').first().click();
  await article(page).waitFor({ state: 'detached' });
  await drawn(page);
  await page.getByRole('button', { name: 'Curso', exact: true }).click();
  await article(page).getByRole('heading', { name: titleOf('05-and', 'pt') }).waitFor();
  await page.getByRole('button', { name: 'Desenho', exact: true }).click();
  await article(page).waitFor({ state: 'detached' });
  await done(page);
});
