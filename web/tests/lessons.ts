// Pictures of the course, of an exercise, of a graded class and of the print preview, for the book (`pictures.ts`).
import { spawnSync } from 'node:child_process';
import { copyFileSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import type { Browser } from 'playwright-core';
import { drawn, openWith, playground, program, type Opened, type Site } from './lib';
import { take } from './take';

const ROOT = new URL('../..', import.meta.url).pathname;
const BOOK = join(ROOT, 'docs/book/src');
const PRESS = join(ROOT, 'exercises/press');
const EXAMPLE = 'structure/macro-step.g7';
const SIZE = { width: 1440, height: 860 };
const MOST = 160_000;

export async function lessons(b: Browser): Promise<void> {
  for (const folder of ['editor', 'cli']) mkdirSync(join(BOOK, folder, 'img'), { recursive: true });
  const read = (path: string) => readFileSync(join(ROOT, 'examples', path), 'utf8');
  const site = await playground({ [EXAMPLE]: read(EXAMPLE), 'structure/drill.svg': read('structure/drill.svg') });
  try {
    await chapter(b, site);
    await exercise(b, site);
    await paper(b, site);
    await graded(b);
  } finally {
    await site.stop();
  }
}

async function chapter(b: Browser, site: Site): Promise<void> {
  const page = await openWith(b, site, '', {}, SIZE);
  await page.getByRole('button', { name: /^4 / }).click();
  await drawn(page);
  await page.waitForTimeout(3_000);
  await take(page, join(BOOK, 'editor/img/course.jpg'), MOST);
  await page.context().close();
}

/** A solution that passes only what is seen, and the model solution. */
async function exercise(b: Browser, site: Site): Promise<void> {
  const page = await openWith(b, site, EXAMPLE, { view: 'both' }, SIZE);
  await page.getByRole('button', { name: 'Gallery' }).click();
  await page.getByRole('button', { name: /A press with two-hand control/ }).click();
  await page.locator('.sheet [data-id="Press/s/Ready"]').waitFor({ state: 'attached' });
  await solved(page, join(PRESS, 'wrong/one-hand.g7'), /All that you see passes/);
  await take(page, join(BOOK, 'editor/img/exercise-fails.jpg'), MOST);
  await solved(page, join(PRESS, 'model.g7'), /All is right/);
  await take(page, join(BOOK, 'editor/img/exercise-passes.jpg'), MOST);
  await page.context().close();
}

async function solved(page: Opened, file: string, said: RegExp): Promise<void> {
  await page.locator('.cm-content').click();
  await page.keyboard.press('Control+a');
  await page.keyboard.insertText(readFileSync(file, 'utf8'));
  await page.waitForTimeout(1_000);
  await page.locator('.exercise').getByRole('button', { name: 'Check my solution' }).click();
  await page.locator('.cm-content').click();
  await page.keyboard.press('Control+Home');
  await page.mouse.move(1, 1);
  await page.locator('.exercise .result').filter({ hasText: said }).waitFor({ timeout: 30_000 });
}

async function paper(b: Browser, site: Site): Promise<void> {
  const page = await openWith(b, site, EXAMPLE, {}, SIZE);
  await drawn(page);
  await page.keyboard.press('Control+p');
  const dialog = page.getByRole('dialog');
  await dialog.getByRole('combobox').first().selectOption({ label: 'the whole dossier' });
  await dialog.getByRole('status').filter({ hasText: /sheet 1 of \d\d/ }).waitFor({ timeout: 60_000 });
  await dialog.getByRole('textbox', { name: 'Title' }).fill('Drilling station');
  await dialog.getByRole('textbox', { name: 'Company' }).fill('Atelier Sud');
  for (let k = 0; k < 2; k++) await dialog.getByRole('button', { name: 'Next sheet' }).click();
  await dialog.getByRole('status').filter({ hasText: /sheet 3 of \d\d/ }).waitFor();
  await page.waitForTimeout(2_000);
  await take(page, join(BOOK, 'cli/img/dossier.jpg'), MOST);
  await page.context().close();
}

/** A class of five: the model solution twice, under other names, and the wrong ones. */
async function graded(b: Browser): Promise<void> {
  const place = mkdtempSync(join(tmpdir(), 'g7-class-'));
  try {
    const [inbox, report] = [join(place, 'handed-in'), join(place, 'report')];
    mkdirSync(inbox);
    const names = ['Bruno', 'Chloé', 'Diogo', 'Emma', 'Farid'];
    const wrong = readdirSync(join(PRESS, 'wrong')).map((name) => join(PRESS, 'wrong', name));
    [join(PRESS, 'model.g7'), ...wrong].forEach((file, k) => copyFileSync(file, join(inbox, `${names[k]}.g7`)));
    copyFileSync(join(PRESS, 'model.g7'), join(inbox, 'Ana.g7'));
    spawnSync(program(), ['grade', 'exercises/press', inbox, '--html', report], { cwd: ROOT, stdio: ['ignore', 'ignore', 'inherit'] });
    const context = await b.newContext({ viewport: { width: 1100, height: 620 } });
    const page = await context.newPage();
    await page.goto(pathToFileURL(join(report, 'index.html')).href);
    await page.getByText('Ana').first().waitFor();
    await take(page, join(BOOK, 'cli/img/graded.jpg'), MOST);
    await context.close();
  } finally {
    rmSync(place, { recursive: true, force: true });
  }
}
