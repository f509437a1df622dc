// Compares the main-thread time of the editor and of React Flow for the same chart, in one session:
// `npm run bench` in web/. Prints a table; fails if a limit is exceeded.
import type { CDPSession, Page } from 'playwright-core';
import { browser, playground } from '../tests/lib';

const SIZE = { width: 1600, height: 900 };
const TICKS = 75;
const MOVES = 60;
const limits = { first: 100, tick: 3, whole: 10, pan: 5, run: 3 };

interface Row {
  name: string;
  first: number;
  heap: number;
  tick: number;
  whole: number;
  pan: number;
  /** One tick of a real run, everything included. */
  run: number;
}

type Bench = { ready(): Promise<void>; show(n: number): Promise<void>; tick(n: number): void; run(): Promise<void>; whole(): void; actual(): void };

class Meter {
  constructor(readonly session: CDPSession) {}

  async value(name: string): Promise<number> {
    const { metrics } = await this.session.send('Performance.getMetrics');
    return metrics.find((m) => m.name === name)?.value ?? 0;
  }

  /** The main-thread time of some work, in ms. */
  async of(work: () => Promise<unknown>): Promise<number> {
    const before = await this.value('TaskDuration');
    await work();
    return ((await this.value('TaskDuration')) - before) * 1000;
  }
}

const settle = (page: Page) => page.waitForTimeout(400);

async function ticks(page: Page): Promise<void> {
  await page.evaluate(
    (count) =>
      new Promise<void>((done) => {
        const bench = (window as unknown as { bench: Bench }).bench;
        let n = 0;
        const timer = setInterval(() => {
          bench.tick(n++);
          if (n < count) return;
          clearInterval(timer);
          done();
        }, 40);
      }),
    TICKS,
  );
}

async function pan(page: Page): Promise<void> {
  await page.mouse.move(700, 500);
  await page.mouse.down({ button: 'middle' });
  for (let i = 1; i <= MOVES; i++) await page.mouse.move(700 - i * 8, 500 - i * 3);
  await page.mouse.up({ button: 'middle' });
}

/** Presses on the paper, where there is no symbol. */
async function panByLeft(page: Page): Promise<void> {
  await page.mouse.move(1590, 500);
  await page.mouse.down();
  for (let i = 1; i <= MOVES; i++) await page.mouse.move(1590 - i * 8, 500 - i * 3);
  await page.mouse.up();
}

async function measure(url: string, name: string, steps: number, own: boolean): Promise<Row> {
  const b = await browser();
  const page = await (await b.newContext({ viewport: SIZE })).newPage();
  page.on('pageerror', (e) => console.error(name, e.message));
  await page.goto(url);
  const session = await page.context().newCDPSession(page);
  // Thread ticks measure CPU time, whatever else the machine does.
  await session.send('Performance.enable', { timeDomain: 'threadTicks' });
  const meter = new Meter(session);
  await page.waitForFunction(() => 'bench' in window);
  await page.evaluate(() => (window as unknown as { bench: Bench }).bench.ready());
  await settle(page);
  const first = await meter.of(() => page.evaluate((n) => (window as unknown as { bench: Bench }).bench.show(n), steps));
  await settle(page);
  const heap = (await meter.value('JSHeapUsedSize')) / 1e6;
  await page.evaluate(() => (window as unknown as { bench: Bench }).bench.actual());
  await settle(page);
  const moved = await meter.of(() => (own ? pan(page) : panByLeft(page)));
  await page.evaluate(() => (window as unknown as { bench: Bench }).bench.actual());
  await settle(page);
  const near = await meter.of(() => ticks(page));
  await page.evaluate(() => (window as unknown as { bench: Bench }).bench.whole());
  await settle(page);
  const far = await meter.of(() => ticks(page));
  let run = Number.NaN;
  if (own) {
    await page.evaluate(() => (window as unknown as { bench: Bench }).bench.run());
    await settle(page);
    run = (await meter.of(() => page.waitForTimeout(TICKS * 40))) / TICKS;
  }
  if (process.env.G7_SHOTS) await page.screenshot({ path: `${process.env.G7_SHOTS}/${name.replace(/\W+/g, '-')}.png` });
  await b.done();
  return { name, first, heap, tick: near / TICKS, whole: far / TICKS, pan: moved / MOVES, run };
}

const site = await playground({});
const only = process.argv[2];
const rows: Row[] = [];
const cases: [string, string, number, boolean][] = [
  ['G7, 1000 steps', 'g7.html', 1000, true],
  ['G7, 5000 steps', 'g7.html', 5000, true],
  ['React Flow, 1000 steps, visible only', 'flow.html', 1000, false],
  ['React Flow, 1000 steps, all', 'flow.html?all', 1000, false],
];
const shown = (n: number) => (Number.isNaN(n) ? '–' : n.toFixed(n < 20 ? 1 : 0));
console.log('| canvas | first picture, CPU ms | heap MB | ms a tick at 100 % | ms a tick, whole chart | pan ms a move | ms a tick, running |');
console.log('|---|---|---|---|---|---|---|');
for (const [name, file, steps, own] of cases) {
  if (only && !name.startsWith(only)) continue;
  const r = await measure(site.url + file, name, steps, own);
  rows.push(r);
  console.log(`| ${r.name} | ${[r.first, r.heap, r.tick, r.whole, r.pan, r.run].map(shown).join(' | ')} |`);
}
await site.stop();

const ours = rows[0];
if (ours?.name.startsWith('G7')) {
  const over = Object.entries(limits).filter(([key, limit]) => ours[key as keyof typeof limits] > limit);
  over.forEach(([key, limit]) => console.error(`over the limit: ${key} takes ${shown(ours[key as keyof typeof limits])} ms of ${limit}`));
  if (over.length > 0) process.exitCode = 1;
}
