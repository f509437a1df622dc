// `make pictures`: a picture of every example at work, for the book and the README. Time is
// virtual: each message advances a run by the same step up to the wanted instant, so that the
// pictures show the same situation each time. The page of the operator is shown with a machine at work.
import assert from 'node:assert/strict';
import { mkdirSync, readdirSync, readFileSync } from 'node:fs';
import { dirname, join, relative } from 'node:path';
import type { Browser, Page } from 'playwright-core';
import { browser, open, openWith, playground, type Site } from './lib';
import { lessons } from './lessons';
import { bench, Machine } from './machine';
import { take } from './take';

const ROOT = new URL('../..', import.meta.url).pathname;
const BOOK = join(ROOT, 'docs/book/src/examples/img');
const README = join(ROOT, 'docs/img/editor.jpg');
const OPERATOR = join(ROOT, 'docs/book/src/online/img/operator.jpg');
const CHANGE = join(ROOT, 'docs/book/src/online/img/change.jpg');
const WIRING = join(ROOT, 'docs/book/src/online/img/wiring.jpg');
const PANEL = join(ROOT, 'docs/book/src/online/img/panel.jpg');
const DEMO = join(ROOT, 'docs/book/src/online/img/bench.jpg');
const PROVE = join(ROOT, 'docs/book/src/prove/img/panel.jpg');
const COMPARE = join(ROOT, 'docs/book/src/prove/img/compare.jpg');
const SHEET = join(ROOT, 'docs/book/src/editor/img/picture.jpg');
const STEP_MS = 20;

/** A chart with a conflict and a step that nothing reaches, for the panel of proofs. */
const FORK = `input start, left, right, arrived : BOOL
output run : BOOL
chart Trolley {
  initial step 1
  step 2 { N run }
  step 3
  step 4
  step 5 "service"
  1 -> 2 when ↑start
  2 -> 3 when left
  2 -> 4 when right
  3 -> 1 when ↑arrived
  4 -> 1 when ↑arrived
  5 -> 1 when ↑arrived
}

prove never X3 and X4
prove X2 leads to X1
`;

/** An act before the picture: an input is switched, a button is pushed, a value is written, or time
 * passes, or a value is chosen. */
type Act = number | { turn: string } | { push: string } | { write: [string, string] } | { choose: [string, string] };
interface Scene {
  acts: Act[];
  /** The chart to show, if it is not the first. */
  chart?: string;
  /** The macro-step whose active step is shown, if the chart is larger than the picture. */
  within?: string;
}

const push = (name: string): Act => ({ push: name });
const turn = (name: string): Act => ({ turn: name });

const SCENES: Record<string, Scene> = {
  'actions/continuous.g7': { acts: [push('go'), turn('c'), 2000] },
  'actions/counters-timers.g7': { acts: [push('go'), push('piece'), push('piece'), turn('c'), 1500] },
  'actions/pl7.g7': { acts: [{ write: ['level', '64'] }, push('push'), 1200] },
  'actions/qualifiers.g7': { acts: [push('go'), 2500] },
  'actions/stored.g7': { acts: [push('go'), push('c'), 300, push('c'), 700] },
  'bead-sorter/chart.g7': { acts: [4000] },
  'bead-sorter/exercise-1.g7': { acts: [6000], within: 'Sequencing' },
  'bead-sorter/exercise-2.g7': { acts: [15000], within: 'Sequencing' },
  'bead-sorter/exercise-3.g7': { acts: [24000] },
  'bead-sorter/exercise-4.g7': { acts: [6000], within: 'Sequencing' },
  'bead-sorter/template.g7': { acts: [2000] },
  'bottle-conveyor/chart.g7': { acts: [push('start'), 9000] },
  'bottle-conveyor/counter.g7': { acts: [push('start'), 11500] },
  'cell/cell.g7': { acts: [turn('start'), turn('home[1]'), turn('home[2]'), turn('home[4]'), 800, turn('reached[1]'), 800], chart: 'Axis' },
  'modelling/conflict.g7': { acts: [push('p1'), push('p2'), turn('t1'), turn('t2'), 200] },
  'modelling/conflict-priority.g7': { acts: [push('p1'), push('p2'), 200] },
  'modelling/machine.g7': { acts: [push('m'), 6000] },
  'modelling/or-into-and.g7': { acts: [push('p1'), 500] },
  'parts/gallery.g7': { acts: [push('start'), 2300] },
  'structure/clamps.g7': { acts: [turn('start'), 300, turn('closed[1]'), 700], chart: 'Move' },
  'structure/enclosing.g7': { acts: [turn('on'), 7000], chart: 'Pumps' },
  'structure/gemma.g7': { acts: [turn('auto'), 2000, push('start'), 800], chart: 'Modes' },
  'structure/drives.g7': { acts: [push('start'), 200, turn('contactor[3]'), 400, turn('contactor[2]'), 900] },
  'structure/instances.g7': { acts: [turn('start'), turn('home[1]'), turn('home[2]'), turn('home[4]'), turn('home[5]'), 800, turn('reached[1]'), turn('reached[4]'), 800] },
  'structure/linked-charts.g7': { acts: [turn('gate'), turn('start'), 2500], chart: 'Wash' },
  'structure/macro-step.g7': { acts: [push('start'), 2600], chart: 'Drill' },
  'structure/modes.g7': { acts: [{ choose: ['selector', 'Automatic'] }, 2500] },
  'structure/task.g7': { acts: [push('start'), 2400] },
  'transport-workcell/alternating.g7': { acts: [9000] },
  'transport-workcell/basic.g7': { acts: [8000] },
  'transport-workcell/improved.g7': { acts: [11000] },
  'two-tanks/chart.g7': { acts: [push('m'), 6000] },
};

/** The examples as the playground has them. */
function examples(): Record<string, string> {
  const folder = join(ROOT, 'examples');
  const found: Record<string, string> = {};
  for (const entry of readdirSync(folder, { recursive: true, withFileTypes: true })) {
    if (!entry.isFile() || !/\.(g7|svg)$/.test(entry.name)) continue;
    const path = join(entry.parentPath, entry.name);
    found[relative(folder, path)] = readFileSync(path, 'utf8');
  }
  return found;
}

/** Replaces the wall clock of the page's runs. */
function still(step: number): void {
  const left = { ms: 0 };
  Object.assign(window, { left });
  const send = Worker.prototype.postMessage as (this: Worker, message: unknown) => void;
  Worker.prototype.postMessage = function (this: Worker, message: unknown) {
    if (typeof message !== 'string' || !message.includes('"run_advance"')) return send.call(this, message);
    const asked = JSON.parse(message) as { do: string; ms: number };
    asked.ms = Math.min(step, left.ms);
    left.ms -= asked.ms;
    send.call(this, JSON.stringify(asked));
  };
}

const oneScan = (page: Page) => page.getByRole('button', { name: 'One scan', exact: true }).click();
const clock = async (page: Page) => parseFloat(await page.locator('.clock').innerText());

async function pass(page: Page, ms: number): Promise<void> {
  const from = await clock(page);
  await page.evaluate((ms) => ((window as unknown as { left: { ms: number } }).left.ms = ms), ms);
  await page.getByRole('button', { name: 'Run', exact: true }).click();
  await page.waitForFunction(() => (window as unknown as { left: { ms: number } }).left.ms <= 0, null, { timeout: 60_000 });
  await page.getByRole('button', { name: 'Pause', exact: true }).click();
  await page.waitForTimeout(150);
  assert.ok(Math.abs((await clock(page)) - from - ms / 1000) < 0.011, `${await clock(page)} s after ${from} s and ${ms} ms`);
}

async function act(page: Page, what: Act): Promise<void> {
  if (typeof what === 'number') return pass(page, what);
  if ('choose' in what) {
    const [name, value] = what.choose;
    return void (await page.getByRole('combobox', { name: `Value of ${name}`, exact: true }).selectOption(value));
  }
  if ('write' in what) {
    const field = page.getByRole('textbox', { name: `Value of ${what.write[0]}`, exact: true });
    await field.fill(what.write[1]);
    await field.press('Enter');
    return oneScan(page);
  }
  const name = 'turn' in what ? what.turn : what.push;
  const signal = page.getByRole('region', { name: 'Signals' }).getByRole('switch', { name, exact: true });
  await signal.click();
  await oneScan(page);
  if ('turn' in what) return;
  await signal.click();
  await oneScan(page);
}

async function shown(b: Browser, site: Site, file: string, scene: Scene, size: { width: number; height: number }): Promise<Page> {
  const page = await open(b, site, file, size, (context) => context.addInitScript(still, STEP_MS));
  if (scene.chart) await page.getByRole('button', { name: new RegExp(`^${scene.chart}\\b`) }).first().click();
  await oneScan(page);
  await page.locator('.clock').waitFor();
  for (const what of scene.acts) await act(page, what);
  if (scene.within) {
    await page.locator(`.steps button.on[title^="${scene.within}."]`).first().evaluate((step: HTMLElement) => step.click());
    await page.waitForTimeout(800);
    await page.locator('.sheet').focus();
    await page.keyboard.press('Escape');
    await page.getByRole('tab', { name: 'Operate' }).click();
  }
  await page.evaluate(() => (document.activeElement as HTMLElement | null)?.blur());
  await page.mouse.move(1, 1);
  await page.waitForTimeout(300);
  assert.deepEqual(page.errors, [], file);
  return page;
}

/** The page of the operator: the mixer at work, with one value forced. */
async function operator(b: Browser): Promise<void> {
  const machine = await Machine.start();
  try {
    const page = await open(b, { url: machine.url, stop: async () => undefined }, undefined, { width: 1280, height: 800 });
    await page.getByRole('button', { name: 'Start', exact: true }).click();
    machine.press(true);
    await page.getByRole('region', { name: 'Active steps' }).getByText('stirring').waitFor();
    await page.getByRole('button', { name: 'Force lamp' }).click();
    await page.getByRole('dialog').getByRole('radio', { name: 'TRUE' }).check();
    await page.getByRole('dialog').getByRole('button', { name: 'Force', exact: true }).click();
    await page.getByRole('dialog').waitFor({ state: 'detached' });
    await page.waitForTimeout(1500);
    // A busy machine may leave a scan out while the browser starts.
    const seen = page.getByRole('button', { name: 'Acknowledge all' });
    if (await seen.isVisible()) await seen.click();
    await page.mouse.move(1, 1);
    await page.evaluate(() => (document.activeElement as HTMLElement | null)?.blur());
    await page.waitForTimeout(300);
    assert.deepEqual(page.errors, [], 'operator');
    await take(page, OPERATOR, 120_000);
    machine.edit((chart) => chart.replace('step 2 "stirring"', 'step 22 "mixing"').replace('(2, 4)', '(22, 4)').replace('2 -> 3 when 30s/X2', '22 -> 3 when 30s/X22'));
    await page.getByRole('button', { name: 'Take over…' }).click();
    await page.getByRole('button', { name: 'Take over', exact: true }).click();
    await page.getByText('This would be lost').waitFor();
    await page.mouse.move(1, 1);
    await take(page, CHANGE, 120_000);
    await page.context().close();
  } finally {
    await machine.done();
  }
}

/** The wiring of the mixer, with the form of one wire. */
async function wiring(b: Browser): Promise<void> {
  const machine = await Machine.editor();
  try {
    const page = await open(b, { url: machine.url, stop: async () => undefined }, undefined, { width: 1280, height: 860 });
    await page.getByRole('button', { name: 'Wiring', exact: true }).click();
    await page.getByText('answers', { exact: true }).waitFor();
    await page.getByRole('button', { name: 'Change high' }).click();
    await page.getByRole('form', { name: 'Wire high' }).getByLabel('Address, from 0').waitFor();
    await page.mouse.move(1, 1);
    await page.evaluate(() => (document.activeElement as HTMLElement | null)?.blur());
    await page.waitForTimeout(1500);
    assert.deepEqual(page.errors, [], 'wiring');
    await take(page, WIRING, 120_000);
    await page.context().close();
  } finally {
    await machine.done();
  }
}

/** A panel at work, on the page of the operator. */
async function panel(b: Browser): Promise<void> {
  const machine = await Machine.desk();
  try {
    const page = await open(b, { url: machine.url, stop: async () => undefined }, undefined, { width: 1280, height: 860 });
    const desk = page.getByRole('region', { name: 'Panel desk' });
    await desk.getByRole('radio', { name: /F1/ }).click();
    await desk.getByRole('radio', { name: /F1/, checked: true }).waitFor();
    await desk.getByRole('button', { name: 'Start' }).hover();
    await page.mouse.down();
    await page.getByRole('region', { name: 'Active steps' }).getByText('filling').waitFor();
    await page.waitForTimeout(800);
    assert.deepEqual(page.errors, [], 'panel');
    await take(page, PANEL, 120_000);
    await page.mouse.up();
    await page.context().close();
  } finally {
    await machine.done();
  }
}

/** The bench with its parts at work. */
async function demo(b: Browser): Promise<void> {
  const { url, end } = await bench();
  try {
    const page = await open(b, { url, stop: async () => undefined }, undefined, { width: 1280, height: 800 });
    await page.locator('#controller.plugged a').waitFor();
    await page.waitForTimeout(4000);
    await take(page, DEMO, 120_000);
    await page.context().close();
  } finally {
    await end();
  }
}

/** The panel of proofs, with a run that breaks a claim. */
async function proofs(b: Browser): Promise<void> {
  const site = await playground({ 'trolley.g7': FORK });
  try {
    const page = await openWith(b, site, 'trolley.g7', { theme: 'light', bottomOpen: true, bottom: 330, minimap: false }, { width: 1280, height: 860 });
    await page.getByRole('tab', { name: /^Prove/ }).click();
    await page.getByText('Everything is answered.').waitFor();
    await page.getByRole('button', { name: 'Play the run on the chart: prove never X3 and X4' }).click();
    await page.getByRole('button', { name: 'Save as a test' }).waitFor();
    await page.waitForTimeout(3000);
    await take(page, PROVE, 100_000);
    await page.context().close();
  } finally {
    await site.stop();
  }
}

/** The panel of comparisons, with two charts at their first difference. */
async function compared(b: Browser): Promise<void> {
  const one = FORK.replace('output run', 'output run, horn').replace('step 4\n', 'step 4 { N horn }\n');
  const other = one.replace('when right', 'when right and not left');
  const site = await playground({ 'trolley.g7': one, 'trolley-2.g7': other });
  try {
    const page = await openWith(b, site, 'trolley.g7', { theme: 'light', bottomOpen: true, bottom: 620, minimap: false, leftOpen: false, rightOpen: false }, { width: 1280, height: 860 });
    await page.getByRole('tab', { name: /^Compare/ }).click();
    await page.getByRole('tabpanel').getByRole('combobox').first().selectOption('trolley-2.g7');
    await page.getByRole('tabpanel').getByRole('button', { name: 'Compare' }).click();
    await page.getByText(/^Different/).waitFor();
    await page.locator('[data-apart]').first().waitFor({ state: 'attached' });
    await page.locator('.sides').evaluate((e) => e.scrollIntoView());
    await take(page, COMPARE, 100_000);
    await page.context().close();
  } finally {
    await site.stop();
  }
}

/** The editor of pictures, with a tank whose level is bound. */
async function drawing(b: Browser, site: Site): Promise<void> {
  const page = await openWith(b, site, 'parts/gallery.g7', { theme: 'light' }, { width: 1280, height: 760 });
  await page.getByRole('tab', { name: 'Operate' }).click();
  await page.getByRole('button', { name: 'Edit picture' }).click();
  const dialog = page.getByRole('dialog', { name: 'Picture of Gallery' });
  await dialog.locator('.page').waitFor();
  await dialog.getByRole('combobox', { name: 'On the sheet' }).selectOption({ label: 'tank1' });
  await dialog.getByText('tank1_liquid.level').scrollIntoViewIfNeeded();
  assert.deepEqual(page.errors, [], 'drawing');
  await take(page, SHEET, 120_000);
  await page.context().close();
}

const wanted = process.argv.slice(2);
const files = examples();
assert.deepEqual(Object.keys(files).filter((f) => f.endsWith('.g7') && !f.includes('/lib/')).sort(), Object.keys(SCENES).sort(), 'an example without a scene');
mkdirSync(BOOK, { recursive: true });
mkdirSync(dirname(OPERATOR), { recursive: true });
mkdirSync(dirname(PROVE), { recursive: true });
const site = await playground(files);
const b = await browser();
try {
  for (const [file, scene] of Object.entries(SCENES)) {
    if (wanted.length > 0 && !wanted.some((w) => file.includes(w))) continue;
    const page = await shown(b, site, file, scene, { width: 1280, height: 800 });
    await take(page, join(BOOK, `${file.replace('/', '-').replace(/\.g7$/, '')}.jpg`), 90_000);
    await page.context().close();
    process.stdout.write(`${file}\n`);
  }
  if (wanted.length === 0 || wanted.includes('README')) {
    const page = await shown(b, site, 'bead-sorter/chart.g7', { acts: [] }, { width: 1440, height: 900 });
    await page.getByRole('button', { name: 'Bottom' }).click();
    await page.getByRole('tab', { name: 'Chronogram' }).click();
    await act(page, 4000);
    await page.getByRole('button', { name: 'Whole run' }).click();
    await page.waitForTimeout(500);
    await take(page, README, 250_000);
    await page.context().close();
    process.stdout.write('README\n');
  }
  if (wanted.length === 0 || wanted.includes('drawing')) {
    await drawing(b, site);
    process.stdout.write('drawing\n');
  }
  if (wanted.length === 0 || wanted.includes('proofs')) {
    await proofs(b);
    await compared(b);
    process.stdout.write('proofs\n');
  }
  if (wanted.length === 0 || wanted.includes('lessons')) {
    await lessons(b);
    process.stdout.write('lessons\n');
  }
  if (wanted.includes('wiring')) {
    await wiring(b);
    await panel(b);
  }
  if (wanted.length === 0 || wanted.includes('operator')) {
    await operator(b);
    await wiring(b);
    await panel(b);
    await demo(b);
    process.stdout.write('operator\n');
  }
} finally {
  await b.done();
  await site.stop();
}
