// Runs in the page: the chart moves, is operated, forced, compared, changed, looked back on, and
// shown over time.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { axe, browser, open, playground, until, type Site } from './lib';

const example = (path: string) => readFileSync(new URL(`../../examples/${path}`, import.meta.url), 'utf8');

const LAMP = `input push : BOOL "push button"
input level : INT
output lamp : BOOL
var n : INT

chart G1 {
  initial step 0
  step 1 { N lamp }
  step 2 { N lamp }
  0 -> 1 when ↑push
  1 -> 2 when 500ms/X1
  2 -> 0 when 500ms/X2
}
`;

// Two transitions clear in one scan: the situation {1} is transient under iec60848.
const FLEETING = `input a : BOOL
output M : BOOL
chart G1 {
  initial step 0
  step 1
  step 2 { N M }
  0 -> 1 when a
  1 -> 2 when a
  2 -> 0 when not a
}
`;

// Three axes, drawn once; each with a situation of its own.
const AXES = `input go : ARRAY[1..3] OF BOOL
output motor : ARRAY[1..3] OF BOOL

chart Axis(i : INT) {
  initial step 1
  step 2 { N motor[i] }
  1 -> 2 when go[i]
  2 -> 1 when not go[i]
}

instance Axis[1..2]
instance Last : Axis(3)
`;

// Six instances of a function block with four members each, and so many variables that the list is long.
const DRIVES = `function block Keep {
  input raw : BOOL
  output q : BOOL
  output calls : INT
  var spare : BOOL
  body {
    q := raw
    calls := calls + 1
    spare := not q
  }
}
var d : ARRAY[1..6] OF Keep
var n : ARRAY[1..20] OF INT

post {
  var i : INT
  FOR i := 1 TO 6 DO
    d[i]()
    n[i] := d[i].calls
  END_FOR
}

chart G {
  initial step 1
  step 2
  1 -> 2 when d[1].q
  2 -> 1 when not d[1].q
}
`;

const FAULT = `input a : BOOL
var n, q : INT

chart G1 {
  initial step 0
  step 1 { P1 q := 10 / n }
  0 -> 1 when a
  1 -> 0 when not a
}
`;

let site: Site;
let b: Awaited<ReturnType<typeof browser>>;

before(async () => {
  site = await playground({
    'lamp.g7': LAMP,
    'fleeting.g7': FLEETING,
    'fault.g7': FAULT,
    'axes.g7': AXES,
    'drives.g7': DRIVES,
    'modes.g7': example('structure/modes.g7'),
    'tanks.g7': example('two-tanks/chart.g7'),
    'two-tanks.svg': example('two-tanks/two-tanks.svg'),
    'bead-sorter/exercise-1.g7': example('bead-sorter/exercise-1.g7'),
    'bead-sorter/bead-sorter.svg': example('bead-sorter/bead-sorter.svg'),
    'evil.g7': LAMP.replace('chart G1', "plant P {\n  view 'evil.svg' { lamp.on := lamp }\n}\n\nchart G1"),
    'evil.svg': `<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" viewBox="0 0 40 40" onload="window.bad = 1">
      <script>window.bad = 2</script>
      <style>@import url(http://example.org/x.css);</style>
      <style>svg { background-image: u\\72l(http://example.org/z.png) }</style>
      <style>svg { border-image-source: image-\\73 et('http://example.org/s.png' 1x) }</style>
      <style>@\\69mport 'http://example.org/i.css';</style>
      <style>.on { fill: lime; } rect { fill: red; } :host, svg { position: fixed !important; inset: 0 !important; width: 3000px !important; height: 3000px !important; z-index: 999 !important; }</style>
      <image href="http://example.org/x.png" width="4" height="4"/>
      <foreignObject><p xmlns="http://www.w3.org/1999/xhtml">text</p></foreignObject>
      <a href="javascript:window.bad = 3"><rect width="9" height="9"/></a>
      <use xlink:href="http://example.org/x.svg#a"/>
      <rect style="mask: \\75\\52L( 'http://example.org/m.svg#a')" filter="u\\000072 l(http://example.org/f.svg#a)" width="2" height="2"/>
      <rect data-g7="lamp" onclick="window.bad = 4" style="stroke: url(http://example.org/y)" width="40" height="40"/>
    </svg>`,
  });
  b = await browser();
});

after(async () => {
  await b.done();
  await site.stop();
});

const active = async (p: Page) => (await p.locator('.steps button.on').allInnerTexts()).join(' ');
const clock = (p: Page) => p.locator('.clock').innerText();
const oneScan = (p: Page) => p.getByRole('button', { name: 'One scan', exact: true }).click();

async function end(p: Page & { errors: string[] }): Promise<void> {
  assert.deepEqual(p.errors, []);
  await p.context().close();
}

test('a value of an enumeration is chosen, and one with bounds is held to them', async () => {
  const p = await open(b, site, 'modes.g7');
  await oneScan(p);
  const selector = p.getByRole('combobox', { name: 'Value of selector', exact: true });
  await selector.waitFor();
  assert.deepEqual(await selector.locator('option').allInnerTexts(), ['Off', 'Manual', 'Automatic']);
  assert.equal(await selector.inputValue(), 'Off');
  const phase = p.locator('li', { has: p.locator('.name', { hasText: /^phase$/ }) }).locator('output.value');
  assert.equal(await phase.innerText(), 'Empty');
  await selector.selectOption('Automatic');
  await oneScan(p);
  await until(async () => (await active(p)) === 'Fill', 'the tank is filled');
  await oneScan(p);
  await until(async () => (await phase.innerText()) === 'Filling', 'the phase has its name');
  await p.getByRole('button', { name: 'Manual', exact: true }).click();
  await until(async () => (await selector.inputValue()) === 'Manual', 'the mode switch of the operator');
  await p.getByRole('button', { name: 'Force phase', exact: true }).click();
  await p.getByRole('combobox', { name: 'Value of phase', exact: true }).selectOption('Full');
  await oneScan(p);
  await until(async () => (await p.getByRole('combobox', { name: 'Value of phase', exact: true }).inputValue()) === 'Full', 'it is forced by its name');
  await p.getByRole('button', { name: 'Force valve', exact: true }).click();
  const valve = p.getByRole('textbox', { name: 'Value of valve', exact: true });
  await valve.fill('101');
  await valve.press('Enter');
  await p.getByText('is outside 0 .. 100').first().waitFor();
  await end(p);
});

test('scan by scan: an input is turned, the step follows, its output is lit', async () => {
  const p = await open(b, site, 'lamp.g7');
  await oneScan(p);
  await until(async () => (await active(p)) === '0', 'step 0 is active');
  await p.getByRole('switch', { name: 'push', exact: true }).click();
  await oneScan(p);
  await until(async () => (await active(p)) === '1', 'step 1 is active');
  assert.equal(await p.getByRole('switch', { name: 'lamp', exact: true }).getAttribute('aria-checked'), 'true');
  await end(p);
});

test('the instances of a chart: a table of situations, and the marks of the chosen one', async () => {
  const p = await open(b, site, 'axes.g7');
  await oneScan(p);
  await p.getByRole('switch', { name: 'go[2]', exact: true }).click();
  await oneScan(p);
  const rows = async () => (await p.locator('section[aria-label="Instances"] tbody tr').allInnerTexts()).map((row) => row.replace(/\s+/g, ' ').trim());
  await until(async () => (await rows()).join(', ') === 'Axis[1] 1, Axis[2] 2, Last 1', 'a row for each instance');
  const mark = () => p.locator('.live path.on').getAttribute('d');
  const here = p.locator('nav [aria-current="page"]');
  assert.equal(await here.innerText(), 'Axis[1]');
  const first = await mark();
  await p.getByRole('button', { name: 'Axis[2]', exact: true }).click();
  await until(async () => (await here.innerText()) === 'Axis[2]', 'the drawing shows the second instance');
  await until(async () => (await mark()) !== first, 'another step is marked');
  await p.getByRole('button', { name: 'Last', exact: true }).click();
  await until(async () => (await mark()) === first, 'the step of the last one');
  await p.getByRole('switch', { name: 'go[2]', exact: true }).click();
  await oneScan(p);
  await until(async () => (await rows())[1] === 'Axis[2] 1', 'back again');
  await end(p);
});

test('the members of structures and function blocks stand in groups, which a long list closes', async () => {
  const p = await open(b, site, 'drives.g7');
  await oneScan(p);
  const signals = p.getByRole('region', { name: 'Signals' });
  const group = (name: RegExp) => signals.locator('summary').filter({ hasText: name });
  const lamp = (name: string) => signals.getByRole('switch', { name, exact: true });
  assert.equal(await lamp('d[2].q').count(), 0);
  await group(/^d 24$/).click();
  await lamp('d[2].raw').click();
  await oneScan(p);
  await until(async () => (await lamp('d[2].q').getAttribute('aria-checked')) === 'true', 'the output follows the input');
  await group(/^d 24$/).click();
  await until(async () => (await lamp('d[2].q').count()) === 0, 'the group is closed again');
  await signals.getByRole('searchbox').fill('[6].q');
  await until(async () => (await lamp('d[6].q').count()) === 1, 'the filter finds a member in a closed group');
  await end(p);
});

test('a number is typed, and a push button is held', async () => {
  const p = await open(b, site, 'lamp.g7');
  await oneScan(p);
  const level = p.getByRole('textbox', { name: 'Value of level' });
  await level.fill('42');
  await level.press('Enter');
  await until(async () => (await level.inputValue()) === '42', 'level is 42');
  await level.fill('many');
  await level.press('Enter');
  await p.getByText(/many/).first().waitFor();
  await until(async () => (await level.inputValue()) === '42', 'what is no number is refused');
  const push = p.getByRole('button', { name: 'Push push' });
  await push.focus();
  await p.keyboard.down('Enter');
  await until(async () => (await p.getByRole('switch', { name: 'push', exact: true }).getAttribute('aria-checked')) === 'true', 'held');
  await p.keyboard.up('Enter');
  await until(async () => (await p.getByRole('switch', { name: 'push', exact: true }).getAttribute('aria-checked')) === 'false', 'let go');
  await end(p);
});

test('Space runs and pauses; time goes on and stands', async () => {
  const p = await open(b, site, 'lamp.g7');
  await p.locator('.sheet').focus();
  await p.keyboard.press(' ');
  await until(async () => parseFloat(await clock(p).catch(() => '0')) > 0.5, 'time goes on');
  await p.locator('.sheet').focus();
  await p.keyboard.press(' ');
  await p.getByRole('button', { name: 'Run', exact: true }).waitFor();
  await p.waitForTimeout(150);
  const stood = await clock(p);
  await p.waitForTimeout(300);
  assert.equal(await clock(p), stood);
  await p.keyboard.press('.');
  await until(async () => (await clock(p)) !== stood, 'one scan');
  assert.ok(Math.abs(parseFloat(await clock(p)) - parseFloat(stood) - 0.01) < 0.006, 'one scan is 10 ms');
  await end(p);
});

test('pass by pass, the transient situation is seen', async () => {
  const p = await open(b, site, 'fleeting.g7');
  await oneScan(p);
  await p.getByRole('switch', { name: 'a', exact: true }).click();
  const seen: string[] = [];
  for (let i = 0; i < 6; i++) {
    await p.getByRole('button', { name: 'One pass: transient situations' }).click();
    const last = await active(p);
    // A pass that changes nothing has no visible effect to wait for.
    for (let n = 0; n < 20 && (await active(p)) === last; n++) await p.waitForTimeout(30);
    const now = await active(p);
    if (seen.at(-1) !== now) seen.push(now);
  }
  assert.deepEqual(seen.filter((s) => s !== '0').slice(0, 2), ['1', '2']);
  await end(p);
});

test('a forced output carries its mark and keeps its value until it is released', async () => {
  const p = await open(b, site, 'lamp.g7');
  await oneScan(p);
  await p.getByRole('button', { name: 'Force lamp' }).click();
  await p.locator('li.forced').waitFor();
  const lamp = p.getByRole('switch', { name: 'lamp', exact: true });
  await lamp.click();
  await oneScan(p);
  await until(async () => (await lamp.getAttribute('aria-checked')) === 'true', 'forced to TRUE');
  await oneScan(p);
  assert.equal(await lamp.getAttribute('aria-checked'), 'true');
  await p.getByRole('button', { name: 'Release lamp' }).click();
  await oneScan(p);
  await until(async () => (await lamp.getAttribute('aria-checked')) === 'false', 'released');
  assert.equal(await p.locator('li.forced').count(), 0);
  await end(p);
});

test('a breakpoint stops the run where the step comes', async () => {
  const p = await open(b, site, 'lamp.g7');
  await oneScan(p);
  await p.locator('[data-id="G1/s/2"]').first().click({ force: true });
  await p.getByRole('button', { name: /^Breakpoints/ }).click();
  await p.getByRole('button', { name: 'Stop at G1.2' }).click();
  await p.keyboard.press('Escape');
  await p.getByRole('tab', { name: 'Operate' }).click();
  await p.getByRole('switch', { name: 'push', exact: true }).click();
  await p.getByRole('button', { name: 'Run', exact: true }).click();
  await p.getByRole('button', { name: 'Stopped at G1.2' }).waitFor();
  assert.equal(await active(p), '2');
  await end(p);
});

test('back in time, and on from there', async () => {
  const p = await open(b, site, 'lamp.g7');
  await oneScan(p);
  await p.getByRole('switch', { name: 'push', exact: true }).click();
  for (let i = 0; i < 8; i++) await oneScan(p);
  await until(async () => (await clock(p)) === '0.09 s', `nine scans: ${await clock(p)}`);
  assert.equal(await active(p), '1');
  const line = p.getByRole('slider', { name: 'Back in time' });
  await line.fill('10');
  await until(async () => (await active(p)) === '0', 'before the push');
  await p.getByRole('button', { name: 'Live', exact: true }).click();
  await until(async () => (await active(p)) === '1' && (await clock(p)) === '0.09 s', 'now again');
  await line.fill('10');
  await until(async () => (await active(p)) === '0', 'before the push');
  await p.getByRole('button', { name: 'Go on from here' }).click();
  await until(async () => (await line.getAttribute('max')) === '10', 'what came after is forgotten');
  await end(p);
});

test('two profiles on the same inputs: the first difference is told', async () => {
  const p = await open(b, site, 'fleeting.g7');
  await p.getByRole('button', { name: 'Compare profiles' }).click();
  await p.getByRole('button', { name: 'Compare with unity' }).click();
  await p.getByText('no difference so far').first().waitFor();
  await p.getByRole('switch', { name: 'a', exact: true }).click();
  await oneScan(p);
  await p.getByText('first difference at 0.010 s').first().waitFor();
  await p.getByRole('button', { name: 'Compare profiles' }).click();
  const rows = await p.locator('[role=dialog] tbody tr').allInnerTexts();
  assert.ok(rows.some((r) => /X2/.test(r) && /TRUE\s+FALSE/.test(r)), rows.join(' | '));
  await end(p);
});

test('a difference of one scan is told, however fast time goes', async () => {
  const p = await open(b, site, 'fleeting.g7');
  await oneScan(p);
  await p.getByRole('button', { name: 'Compare profiles' }).click();
  await p.getByRole('button', { name: 'Compare with unity' }).click();
  await p.getByText('no difference so far').first().waitFor();
  await p.getByRole('switch', { name: 'a', exact: true }).click();
  await p.getByRole('combobox', { name: 'Speed' }).selectOption('100');
  await p.getByRole('button', { name: 'Run', exact: true }).click();
  await p.getByText('first difference at 0.010 s').first().waitFor();
  await p.getByRole('button', { name: 'Run', exact: true }).waitFor();
  await end(p);
});

test('a changed chart is taken over; what would be lost is asked about', async () => {
  const p = await open(b, site, 'lamp.g7');
  await oneScan(p);
  await p.getByRole('switch', { name: 'push', exact: true }).click();
  await oneScan(p);
  await until(async () => (await active(p)) === '1', 'step 1 is active');
  await p.locator('[data-id="G1/s/0"]').first().click({ force: true });
  await p.keyboard.press('Tab');
  await p.keyboard.press('Escape');
  await p.getByText('the situation is kept').waitFor();
  await p.getByRole('tab', { name: 'Operate' }).click();
  assert.equal(await active(p), '1');
  await p.locator('.steps button', { hasText: '1' }).click();
  await p.locator('.sheet').focus();
  await p.keyboard.press('Delete');
  const ask = p.getByRole('dialog', { name: 'Change of the running chart' });
  await ask.waitFor();
  await ask.getByRole('button', { name: 'Take over' }).click();
  await until(async () => (await p.locator('dialog[open]').count()) === 0, 'answered');
  await p.getByRole('tab', { name: 'Operate' }).click();
  assert.ok(!(await active(p)).split(' ').includes('1'), 'step 1 is gone');
  await end(p);
});

test('a fault halts the run, tells its place, and a new start goes on', async () => {
  const p = await open(b, site, 'fault.g7');
  await oneScan(p);
  await p.getByRole('switch', { name: 'a', exact: true }).click();
  await oneScan(p);
  await p.getByRole('button', { name: /^Halted: division by zero/ }).click();
  assert.equal(await p.getByRole('tab', { name: 'Operate' }).count(), 1);
  await p.getByRole('tab', { name: 'Operate' }).click();
  await p.getByRole('button', { name: 'Run', exact: true }).click();
  await until(async () => (await p.getByRole('button', { name: /^Halted/ }).count()) === 0, 'begun anew');
  await until(async () => (await active(p)) === '0', 'step 0 is active again');
  await end(p);
});

test('the picture of a plant moves, and its button works', async () => {
  const p = await open(b, site, 'tanks.g7');
  await oneScan(p);
  const water = p.locator('[data-g7=water1]');
  await until(async () => /^1 0$/.test(await water.evaluate((e) => (e as SVGElement).style.scale)), 'empty');
  const m = p.getByRole('button', { name: 'Start a batch (m)' });
  await m.focus();
  await p.keyboard.down('Enter');
  await oneScan(p).then(() => oneScan(p));
  await p.getByRole('button', { name: 'Run', exact: true }).click();
  await until(async () => parseFloat((await water.evaluate((e) => (e as SVGElement).style.scale)).split(' ')[1] ?? '1') > 0.1, 'it fills');
  assert.ok(await p.locator('path[data-g7=in1]').evaluate((e) => e.classList.contains('on')), 'the inlet is open');
  await end(p);
});

test('a picture brings no scripts, no handlers and nothing from elsewhere', async () => {
  const p = await open(b, site, 'evil.g7');
  const asked: string[] = [];
  p.on('request', (r) => asked.push(r.url()));
  await oneScan(p);
  const lamp = p.locator('rect[data-g7=lamp]');
  await lamp.waitFor();
  await lamp.click({ position: { x: 20, y: 20 }, force: true });
  // It covers nothing but its own frame: the buttons of the bar still work.
  const before = await clock(p);
  await oneScan(p);
  await until(async () => (await clock(p)) !== before, 'one scan');
  const inside = await lamp.evaluate((e) => (e.getRootNode() as ShadowRoot).innerHTML);
  for (const word of ['script', 'onload', 'onclick', 'example.org', 'image', 'foreignObject', 'javascript', '@import']) {
    assert.ok(!inside.includes(word), `${word} in ${inside}`);
  }
  assert.equal(await p.evaluate(() => (window as { bad?: number }).bad), undefined);
  assert.deepEqual(asked.filter((u) => !u.startsWith(site.url)), []);
  // The browser's policy refuses handlers even before the picture is cleaned, and says so.
  p.errors.splice(0, p.errors.length, ...p.errors.filter((text) => !text.includes('inline event handler violates')));
  await end(p);
});

test('the chronogram: cursors by keyboard, the difference of times, a table, files', async () => {
  const p = await open(b, site, 'lamp.g7');
  await oneScan(p);
  await p.getByRole('switch', { name: 'push', exact: true }).click();
  for (let i = 0; i < 6; i++) await oneScan(p);
  if ((await p.getByRole('tab', { name: 'Chronogram' }).count()) === 0) await p.getByRole('button', { name: 'Bottom' }).click();
  await p.getByRole('tab', { name: 'Chronogram' }).click();
  await p.getByRole('button', { name: 'Whole run' }).click();
  await p.waitForTimeout(400);
  const lanes = p.locator('[role=group][aria-label^=Chronogram]');
  await lanes.focus();
  for (let i = 0; i < 8; i++) await p.keyboard.press('ArrowLeft');
  await p.keyboard.press('ArrowRight');
  await p.keyboard.press('Shift+ArrowLeft');
  const said = await p.locator('.cursors').innerText();
  assert.match(said, /A 0\.020 s/);
  assert.match(said, /B 0\.000 s/);
  assert.match(said, /Δ -0\.020 s/);
  await p.getByRole('button', { name: 'As a table' }).click();
  const rows = await p.locator('[role=region][aria-label="Table of edges"] tbody tr').allInnerTexts();
  assert.ok(rows.some((r) => /0\.020 s\s+push\s+TRUE/.test(r)), rows.join(' | '));
  for (const [form, start] of [['CSV', /^time/i], ['VCD', /\$timescale/], ['SVG', /^<svg/]] as const) {
    await p.getByRole('toolbar', { name: 'Chronogram' }).getByRole('button', { name: 'Export', exact: true }).click();
    const [file] = await Promise.all([p.waitForEvent('download'), p.getByRole('button', { name: `Export as ${form}` }).click()]);
    assert.equal(file.suggestedFilename(), `lamp.${form.toLowerCase()}`);
    assert.match(readFileSync(await file.path(), 'utf8'), start);
  }
  await end(p);
});

test('the line of time and the chronogram show one time', async () => {
  const p = await open(b, site, 'lamp.g7');
  await oneScan(p);
  await p.getByRole('switch', { name: 'push', exact: true }).click();
  for (let i = 0; i < 8; i++) await oneScan(p);
  await until(async () => (await clock(p)) === '0.09 s', 'nine scans');
  if ((await p.getByRole('tab', { name: 'Chronogram' }).count()) === 0) await p.getByRole('button', { name: 'Bottom' }).click();
  await p.getByRole('tab', { name: 'Chronogram' }).click();
  await p.getByRole('button', { name: 'Whole run' }).click();
  const line = p.getByRole('slider', { name: 'Back in time' });
  const value = p.locator('.names .name').filter({ hasText: 'push' }).locator('.value');
  await until(async () => (await value.innerText()) === '1', 'the value of now');
  // The chronogram follows the line of time: the values and the mark are those of that instant.
  await line.fill('10');
  await until(async () => (await value.innerText()) === '0', 'the value of then');
  const lanes = p.locator('[role=group][aria-label^=Chronogram]');
  const marked = () =>
    lanes.locator('canvas').nth(1).evaluate((canvas: HTMLCanvasElement) => {
      const accent = document.createElement('i');
      accent.style.color = 'var(--accent)';
      document.body.append(accent);
      const wanted = /\d+, \d+, \d+/.exec(getComputedStyle(accent).color)?.[0];
      accent.remove();
      const { data, width } = canvas.getContext('2d')?.getImageData(0, 2, canvas.width, 1) as ImageData;
      const place = Array.from({ length: width }, (_, x) => x).find((x) => [...data.slice(4 * x, 4 * x + 3)].join(', ') === wanted && data[4 * x + 3] === 255);
      return place === undefined ? Number.NaN : place / width;
    });
  // The whole run is shown, and at least ten scans.
  await until(async () => Math.abs((await marked()) - 0.1) < 0.01, 'the mark stands at 10 ms of 100');
  // The times of the chronogram are a line of time as well.
  const times = await lanes.locator('canvas').first().boundingBox();
  assert.ok(times);
  await p.mouse.move(times.x + times.width * 0.3, times.y + 8);
  await p.mouse.down();
  await p.mouse.move(times.x + times.width * 0.5, times.y + 8, { steps: 4 });
  await p.mouse.up();
  await until(async () => (await line.inputValue()) === '50' && (await active(p)) === '1', 'the chart is that of 50 ms');
  await until(async () => Math.abs((await marked()) - 0.5) < 0.01, 'the mark stands at 50 ms');
  // By keyboard: cursor A, and the chart as it was there.
  await lanes.focus();
  for (let i = 0; i < 8; i++) await p.keyboard.press('ArrowLeft');
  await p.keyboard.press('Enter');
  await until(async () => (await line.inputValue()) === '0' && (await active(p)) === '0', 'the chart is that of A');
  await p.keyboard.press('ArrowRight');
  await p.getByRole('button', { name: 'Go to A' }).click();
  await until(async () => (await line.inputValue()) === '20', 'the chart is that of the next edge');
  assert.deepEqual(await axe(p), []);
  await p.getByRole('button', { name: 'Live', exact: true }).click();
  await until(async () => Number.isNaN(await marked()), 'now has no such mark');
  await end(p);
});

// Exercise 1: one black and one yellow bead in turn; then the button in the picture tilts the unit,
// and each bead returns to its compartment.
test('the bead sorter: a pattern, a tilt, every bead back in its place', async () => {
  const p = await open(b, site, 'bead-sorter/exercise-1.g7');
  await p.getByRole('combobox', { name: 'Speed' }).selectOption('20');
  await p.getByRole('button', { name: 'Run', exact: true }).click();
  const beads = async (of: string) =>
    p.locator(`[data-g7=${of}] .bead`).evaluateAll((all) =>
      all.flatMap((e) => ((e as SVGElement).style.display === 'none' ? [] : [e.classList.contains('y') ? 'y' : 'b'])).join(''),
    );
  // Six black and four yellow beads: four pairs, a fifth black one, and no yellow one is left.
  await until(async () => (await beads('track')) === 'bybybybyb', 'four pairs and a black bead lie in the track', 20_000);
  assert.equal(await beads('one'), 'b');
  await p.getByRole('button', { name: 'Turn over the unit (tilted)' }).click();
  await until(async () => (await beads('track')) === '', 'the track is empty', 30_000);
  await until(async () => (await beads('one')) === 'bbbbbb' && (await beads('two')) === 'yyyy', 'six black, four yellow', 20_000);
  assert.equal(await p.locator('[data-g7=astray]').textContent(), '0');
  await end(p);
});
