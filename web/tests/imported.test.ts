// Stories of charts of other tools: a file of every ending that is read is opened, drawn, and still read
// when somebody types into its text. A test of the crate `page` holds the list to that of the formats.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { after, before, test } from 'node:test';
import { browser, done, drawn, openWith, playground, until, type Site } from './lib';

const FILES = new URL('../../tests/interchange/', import.meta.url);
/** For each ending a file with such a text; tools give one form several endings. */
const ENDINGS: [ending: string, file: string][] = [
  ['.xml', 'jgrafchart/bead-sorter.xml'],
  ['.xml', 'plcopen/press.xml'],
  ['.xml', 's7graph/press.xml'],
  ['.grafcet', 'xmi/mixer.grafcet'],
  ['.xmi', 'xmi/mixer.grafcet'],
  ['.clp', 'classicladder/jumps.clp'],
  ['.clprj', 'classicladder/press.clprj'],
  ['.xsf', 'controlexpert/cell.xsf'],
  ['.xef', 'controlexpert/mixer.xef'],
  ['.l5x', 'l5x/filler.L5X'],
  ['.st', 'iectext/press.st'],
  ['.sfc', 'iectext/press.st'],
  ['.iec', 'iectext/press.st'],
  ['.exp', 'iectext/press.st'],
  ['.il', 'iectext/press.st'],
];

const OWN = 'chart Own {\n  initial step 0\n}\n';

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;

before(async () => {
  site = await playground({ 'own.g7': OWN });
  b = await browser();
});

after(async () => {
  await b?.done();
  await site?.stop();
});

for (const [ending, file] of ENDINGS) {
  test(`a file *${ending} (${file}) is opened, drawn, and still read behind a letter`, async () => {
    const page = await openWith(b, site, 'own.g7', { view: 'both' });
    const chooser = page.waitForEvent('filechooser');
    await page.getByRole('button', { name: 'Open', exact: true }).click();
    await (await chooser).setFiles({ name: `other${ending}`, mimeType: 'text/plain', buffer: await readFile(new URL(file, FILES)) });
    await page.getByRole('tab', { name: /other\.g7/, selected: true }).waitFor();
    const symbols = page.locator('.sheet [data-id*="/s/"]');
    await page.locator('.sheet [data-id="Own/s/0"]').waitFor({ state: 'detached' });
    await symbols.first().waitFor({ state: 'attached' });
    await drawn(page);
    const ids = () => symbols.evaluateAll((all) => all.map((one) => one.getAttribute('data-id')).sort().join(' '));
    const before = await ids();
    const text = page.locator('.cm-content');
    await text.click();
    await page.keyboard.press('Control+End');
    await page.keyboard.type('// a letter');
    await text.getByText('// a letter').waitFor();
    // A lone stroke, typed on the way, is an error; the drawing is that of the present text again.
    await until(async () => (await page.locator('.cm-lint-marker-error').count()) === 0 && (await page.getByText(/there is no chart/).count()) === 0, `${file}: errors in the text`);
    await drawn(page);
    assert.equal(await ids(), before);
    assert.equal(await page.locator('.stale').count(), 0);
    await done(page);
  });
}
