// The weight of the static site, and the time to its first picture on a slow CPU: `make site-bench`. Prints figures; those of time tell of
// the machine.
import { readdirSync, readFileSync, statSync } from 'node:fs';
import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import type { AddressInfo } from 'node:net';
import { extname, join } from 'node:path';
import { browser, TYPES } from '../tests/lib';

const SITE = join(import.meta.dirname, '../../site');
/** The factor by which the thread of the page is slowed down, as in the tools for developers of Chromium. */
const SLOWER = 4;
const TIMES = Number(process.env.TIMES ?? 5);
const CHART = 'modelling/machine.g7';

const megabytes = (bytes: number) => `${(bytes / 1e6).toFixed(2)} MB`;
const packed = readdirSync(SITE, { recursive: true, encoding: 'utf8' }).filter((path) => path.endsWith('.br'));
const sizes = packed.map((path) => [path.slice(0, -'.br'.length), statSync(join(SITE, path)).size] as const).sort((a, b) => b[1] - a[1]);
console.log(`all files as Brotli: ${megabytes(sizes.reduce((sum, [, size]) => sum + size, 0))}`);
for (const [path, size] of sizes.slice(0, 8)) console.log(`  ${megabytes(size)} ${path}`);

const fetched = new Map<string, number>();
const server = createServer((request, response) => {
  const path = new URL(request.url ?? '/', 'http://localhost').pathname.replace(/\/$/, '/index.html');
  readFile(join(SITE, `${path}.br`)).then(
    (bytes) => {
      fetched.set(path, bytes.length);
      response.writeHead(200, { 'content-type': TYPES[extname(path)] ?? 'text/plain', 'content-encoding': 'br' }).end(bytes);
    },
    () => response.writeHead(404).end(),
  );
});
await new Promise<void>((done) => server.listen(0, '127.0.0.1', done));
const url = `http://127.0.0.1:${(server.address() as AddressInfo).port}/?file=${encodeURIComponent(CHART)}`;
if (!(CHART in (JSON.parse(readFileSync(join(SITE, 'examples.json'), 'utf8')) as object))) throw new Error(`there is no ${CHART}`);

const b = await browser();
for (const slower of [1, SLOWER]) {
  const times: number[] = [];
  for (let k = 0; k < TIMES; k++) {
    // A context of its own each time, so that nothing comes from a cache.
    const context = await b.newContext({ viewport: { width: 1280, height: 720 } });
    const page = await context.newPage();
    const cdp = await context.newCDPSession(page);
    await cdp.send('Emulation.setCPUThrottlingRate', { rate: slower });
    fetched.clear();
    await page.goto(url, { waitUntil: 'commit' });
    await page.waitForSelector('.sheet [data-id]', { state: 'attached' });
    times.push(await page.evaluate(() => new Promise<number>((done) => requestAnimationFrame(() => done(performance.now())))));
    await context.close();
  }
  times.sort((a, b) => a - b);
  const [least, middle, most] = [times[0], times[times.length >> 1], times.at(-1)].map((ms) => `${Math.round(ms ?? 0)} ms`);
  console.log(`first picture, CPU ${slower}× slowed: ${middle} (${least} to ${most}, ${TIMES} times)`);
}
console.log(`fetched for it: ${megabytes([...fetched.values()].reduce((sum, size) => sum + size, 0))}: ${[...fetched.keys()].join(' ')}`);
await b.done();
server.closeAllConnections();
server.close();
