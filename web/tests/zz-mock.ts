import { createServer } from 'node:http';
import { readFileSync, existsSync } from 'node:fs';
import { join } from 'node:path';
import { chromium, type Page } from 'playwright-core';
import { axe } from '/work/w/wizard/web/tests/lib';
const DIST = '/work/w/wizard/web/dist';
const types: Record<string, string> = { html: 'text/html', js: 'text/javascript', css: 'text/css', wasm: 'application/wasm', svg: 'image/svg+xml', woff2: 'font/woff2' };
const machine = readFileSync('/work/w/wizard/web/tests/machine.ts', 'utf8');
const CHART = /const CHART = `([\s\S]*?)`;/.exec(machine)![1]!;
const DESK = /const DESK = `([\s\S]*?)`;/.exec(machine)![1]!;
const TANK = /const TANK = `([\s\S]*?)`;/.exec(machine)![1]!;
// the catalogue, read off the Rust table roughly
const set = (key: string, form: any, usual: string, example: string, about: string) => ({ key, form, usual, example, about });
const tcp = [set('host', { is: 'text' }, 'needed', '10.0.0.7', 'its name or address'), set('port', { is: 'whole', least: 1, most: 65535 }, 'is', '502', 'its port'), set('unit', { is: 'whole', least: 0, most: 247 }, 'is', '1', 'the unit or slave'), set('words', { is: 'words', words: ['high-first', 'low-first'] }, 'is', 'high-first', 'the order of numbers in several registers'), set('poll', { is: 'duration', least: '1ms', most: '1h' }, 'is', '20ms', 'the time between two exchanges'), set('timeout', { is: 'duration', least: '1ms', most: '1h' }, 'is', '500ms', 'the longest time of an answer'), set('refresh', { is: 'duration', least: '1ms', most: '1h' }, 'is', '1s', 'outputs that did not change are written again after this time'), set('retry', { is: 'duration', least: '10ms', most: '1h' }, 'is', '2s', 'the longest time between two attempts to reach it')];
const bad = set('bad', { is: 'bad' }, 'is', 'hold', 'its value while the device gives none');
const scale = [set('as', { is: 'words', words: ['u16', 'i16', 'u32', 'i32', 'u64', 'i64', 'f32', 'f64'] }, 'none', 'u16', 'the form of the number in registers; that of the type of the variable without it'), set('scale', { is: 'number' }, 'is', '1.0', 'the value is this times the number of the device'), set('offset', { is: 'number' }, 'is', '0.0', 'and this is added')];
const bits = (word: string, input: boolean, output: boolean, about: string) => ({ word, argument: { is: 'address', most: 65535 }, carries: 'bit', input, output, of_input: [bad], of_output: [], about });
const nums = (word: string, input: boolean, output: boolean, about: string) => ({ ...bits(word, input, output, about), carries: 'number', of_input: [...scale, bad], of_output: scale });
const points = [bits('coil', true, true, 'a bit that can be written'), bits('discrete', true, false, 'a bit that can only be read'), nums('input', true, false, 'a number in registers that can only be read'), nums('holding', true, true, 'a number in registers that can be written'), { ...bits('holding', true, true, 'one bit of a register that can be written'), argument: { is: 'bit', most: 65535 } }, { word: 'good', argument: { is: 'nothing' }, carries: 'bit', input: true, output: false, of_input: [], of_output: [], about: 'TRUE while the device answers' }];
const kinds = [{ word: 'modbus-tcp', about: 'a server of Modbus TCP, which G7 asks', shows: false, settings: tcp, points }, { word: 'panel', about: 'buttons and lamps on the operator page', shows: true, settings: [set('release', { is: 'duration', least: '300ms', most: '10s' }, 'is', '1s', 'a button is released when its page has been silent for so long'), set('press', { is: 'duration', least: '10ms', most: '10s' }, 'is', '200ms', 'a press lasts at least so long')], points: [] }];
const signal = (name: string, role: string, carries: string, type: string, address: string | null, comment: string | null) => ({ name, role, carries, type, address, comment, inverted: false });
const ch = (key: string, at: string, settings = {}) => ({ key, variable: key, at, settings, short: Object.keys(settings).length === 0 });
const sight = { io: 'mixer.io.toml', hash: 'h1', text: '# the mixer\n[devices.rack1]\nkind = "modbus-tcp"\n', read_only: false, asks: true, online: false, chart: [], signals: [signal('start', 'input', 'bit', 'BOOL', '%I0.0', 'start button'), signal('high', 'input', 'bit', 'BOOL', '%I0.1', 'tank is full'), signal('low', 'input', 'bit', 'BOOL', '%I0.2', 'tank is not empty'), signal('temperature', 'input', 'number', 'REAL', null, 'degrees in the tank'), signal('fill', 'output', 'bit', 'BOOL', '%Q0.0', 'inlet valve'), signal('stir', 'output', 'bit', 'BOOL', '%Q0.1', 'stirrer'), signal('lamp', 'output', 'bit', 'BOOL', '%Q0.4', 'ready'), signal('speed', 'output', 'whole', 'INT', null, 'stirrer, turns a minute')], devices: [{ name: 'rack1', kind: 'modbus-tcp', settings: { host: '127.0.0.1', port: 1502, timeout: '1s' } }, { name: 'rack2', kind: 'modbus-tcp', settings: { host: '10.0.0.9' } }, { name: 'desk', kind: 'panel', settings: {} }], channels: { inputs: [ch('start', 'rack1.discrete(0)', { bad: false }), ch('high', 'rack1.discrete(1)'), ch('temperature', 'rack1.input(0)', { as: 'f32', scale: 0.1 }), { key: 'ghost', variable: null, at: 'rack1.coil(9)', settings: {}, short: true }], outputs: [ch('fill', 'rack1.coil(0)'), ch('lamp', 'rack1.discrete(4)'), ch('speed', 'rack1.holding(0)')], shown: [ch('X2', 'desk.value()')] }, problems: [{ code: 'G0703', path: ['outputs', 'lamp'], line: 9, what: '`discrete(4)` cannot be written', help: 'outputs are coils or holding registers', related: [], error: true }, { code: 'G0702', path: ['inputs', 'ghost'], line: 7, what: 'the chart has no input `ghost`', help: null, related: [], error: true }], kinds };
const live = { hash: 'h1', devices: { rack1: { is: 'answers', took_ms: 1.3 }, rack2: { is: 'silent', why: 'Connection error: Connection refused (os error 111)' }, desk: { is: 'panel' } }, values: { start: { value: 'FALSE', raw: 'FALSE' }, high: { value: 'TRUE', raw: 'TRUE' }, temperature: { value: '20.5', raw: '205' }, fill: { value: 'FALSE', raw: 'FALSE' }, speed: { why: 'exception 2: illegal data address' } } };
const sig = (name: string, role: string, bool: boolean, type: string, comment: string, panel: any, device = 'desk') => ({ name, role, bool, type, comment, address: null, device, point: panel ? panel.is + '()' : 'x', forcible: true, panel });
const told = { title: 'filler', file: 'filler.g7', text: DESK, profile: 'iec60848', period_ms: 10, plant: null, signals: [sig('start', 'input', true, 'BOOL', 'Start', { is: 'button' }), sig('hold', 'input', true, 'BOOL', 'Hold', { is: 'switch' }), sig('mode', 'input', false, 'INT', 'Mode', { is: 'choice', words: ['A1', 'F1', 'F4', 'D1'] }), sig('amount', 'input', false, 'REAL', 'Amount, litres', { is: 'number', min: 0, max: 100 }), sig('auto', 'input', true, 'BOOL', 'Automatic', { is: 'switch' }), sig('valve', 'output', true, 'BOOL', 'Inlet valve', { is: 'lamp', colour: 'blue' }), sig('ready', 'output', true, 'BOOL', 'Ready', { is: 'lamp', colour: 'green' }), sig('alarm', 'output', true, 'BOOL', 'Tank is full', { is: 'lamp', colour: 'red' }), sig('count', 'output', false, 'INT', 'Fillings', { is: 'value' })], steps: [{ id: 'Fill/s/1', name: '1', chart: 'Fill', comment: 'filling', macro: false }], transitions: [], devices: [{ name: 'desk', kind: 'panel', place: 'the operator page' }], picture: { file: 'tank.svg', simulated: false, bindings: [{ element: 'water', attribute: 'level', known: true }, { element: 'pipe', attribute: 'open', known: true }, { element: 'lamp', attribute: 'on', known: true }, { element: 'bubbles', attribute: 'dy', known: false }] }, force: { usual_s: 600, longest_s: 86400, most: 64 }, frame: null as any };
const frame = (full: boolean) => ({ full, now: 12, age: 0, mode: { is: 'run', since: 3, reason: null, waits: false }, file: { differs: false, back: false, busy: false }, counts: { scans: 1200, missed: 0, lost: 0, late: { p50_us: 60, p99_us: 90, most_us: 200 }, took: { p50_us: 6, p99_us: 9, most_us: 20 } }, on: [[0, 4200]], enabled: {}, forced: [], devices: [{ up: true, since: 0, why: '' }], events: [{ n: 1, at: 1, kind: 'set', name: 'mode', value: 'F1', who: 'maria', level: 'note', over: true, seen: true }, { n: 2, at: 2, kind: 'pressed', name: 'start', who: null, level: 'note', over: true, seen: true }], values: [[0, 'FALSE', 'good'], [1, 'TRUE', 'good'], [2, '1', 'good'], [3, '80', 'good'], [4, 'FALSE', 'good'], [5, 'TRUE', 'good'], [6, 'TRUE', 'good'], [7, 'TRUE', 'good'], [8, '4', 'good']], view: [[0, 0.6], [1, true], [2, true], [3, 5]] });
told.frame = frame(true);
const server = createServer((req, res) => {
  const url = new URL(req.url!, 'http://x');
  const json = (v: unknown) => { res.setHeader('content-type', 'application/json'); res.end(JSON.stringify(v)); };
  if (url.pathname === '/api/info') return json({ name: 'g7', version: '0', read_only: false, folder: 'x', online: url.pathname.includes('op') || process.env.ON === '1' });
  if (url.pathname === '/api/files') return json({ files: [{ path: 'mixer.g7', size: 1, hash: 'a' }] });
  if (url.pathname === '/api/drafts') return json({ drafts: [] });
  if (url.pathname === '/api/file') { res.setHeader('etag', '"a"'); return res.end(url.searchParams.get('path')!.endsWith('svg') ? TANK : CHART); }
  if (url.pathname === '/api/wiring/look') return json(sight);
  if (url.pathname === '/api/wiring/edit') return json(sight);
  if (url.pathname === '/api/wiring/live') return json(live);
  if (url.pathname.startsWith('/api')) { res.statusCode = 404; return res.end('{}'); }
  let file = join(DIST, url.pathname);
  if (!existsSync(file) || url.pathname === '/' || url.pathname === '/operator') file = join(DIST, 'index.html');
  res.setHeader('content-type', types[file.split('.').at(-1)!] ?? 'text/plain');
  res.end(readFileSync(file));
});
await new Promise<void>((done) => server.listen(0, '127.0.0.1', () => done()));
const base = `http://127.0.0.1:${(server.address() as any).port}/`;
const b = await chromium.launch({ executablePath: '/usr/bin/chromium', args: ['--no-sandbox', '--disable-gpu'] });
const want = process.argv[2];
async function page(width: number, height: number, scheme: 'light' | 'dark', lang: string): Promise<Page> {
  const c = await b.newContext({ viewport: { width, height }, colorScheme: scheme, locale: { en: 'en-GB', fr: 'fr-FR', pt: 'pt-PT' }[lang]!, hasTouch: width < 500 });
  const p = await c.newPage();
  p.on('pageerror', (e) => console.log('ERR', e.message));
  p.on('console', (m) => m.type() === 'error' && console.log('CON', m.text()));
  await p.routeWebSocket('**/api/live**', (ws) => {
    ws.onMessage((m) => { const { id, call } = JSON.parse(String(m)); ws.send(JSON.stringify({ id, answer: { ok: call.do === 'operator_watch' ? told : null } })); });
    setInterval(() => { try { ws.send(JSON.stringify({ operator: frame(false) })); } catch {} }, 100);
  });
  return p;
}
const shots: [string, number, number, 'light' | 'dark', string][] = [['desk', 1280, 860, 'light', 'en'], ['phone', 390, 844, 'dark', 'pt'], ['deskdark', 1280, 860, 'dark', 'fr'], ['phonelight', 390, 844, 'light', 'fr']];
for (const [name, w, h, scheme, lang] of shots) {
  if (want === 'wiring') {
    const p = await page(w, h, scheme, lang);
    await p.goto(base + '?token=t&file=mixer.g7');
    await p.locator('button:has(svg path[d^="M5.500 2.500V6M10.5"])').first().click({ timeout: 60000 });
    await p.locator('dialog .answers').waitFor();
    await p.screenshot({ path: `/tmp/wiz/w-${name}.png` });
    await p.locator('li').filter({ hasText: 'temperature' }).last().locator('.row > .button').click();
    await p.waitForTimeout(300);
    await p.locator('form.wire-form').scrollIntoViewIfNeeded();
    await p.locator('form.wire-form summary').click();
    await p.screenshot({ path: `/tmp/wiz/w-${name}-form.png` });
    console.log(name, 'overflow', await p.evaluate(() => { const e = document.querySelector('dialog .content')!; return e.scrollWidth - e.clientWidth; }), await axe(p));
    await p.locator('section li').filter({ hasText: 'rack1' }).first().locator('.row > .button').click();
    await p.locator('.content').first().evaluate((e) => e.scrollTo(0, 0));
    await p.waitForTimeout(300);
    await p.screenshot({ path: `/tmp/wiz/w-${name}-device.png` });
    console.log(await axe(p));
    await p.context().close();
  } else {
    const p = await page(w, h, scheme, lang);
    await p.goto(base + 'operator?token=t');
    await p.locator('.push').waitFor({ timeout: 60000 });
    await p.waitForTimeout(1500);
    await p.screenshot({ path: `/tmp/wiz/o-${name}.png` });
    if (w < 500) { await p.locator('.push').scrollIntoViewIfNeeded(); await p.evaluate(() => document.querySelector('.parts')!.closest('section')!.scrollIntoView()); await p.waitForTimeout(300); await p.screenshot({ path: `/tmp/wiz/o-${name}-panel.png` }); await p.evaluate(() => document.querySelector('.picture')!.closest('section')!.scrollIntoView()); await p.waitForTimeout(300); await p.screenshot({ path: `/tmp/wiz/o-${name}-picture.png` }); }
    console.log(name, await p.evaluate(() => document.documentElement.scrollWidth - innerWidth), await axe(p));
    await p.context().close();
  }
}
await b.close();
server.close();
