// Stories of a project of several files: a chart of another file is shown and runs, and is changed in its own file.
import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, afterEach, before, beforeEach, test } from 'node:test';
import { browser, open, openWith, serve, until, type Opened, type Site } from './lib';

const AXIS = `input order : ARRAY[1..2] OF BOOL
output out : ARRAY[1..2] OF BOOL

chart Axis(i : INT) {
  initial step 0
  step 1 { N out[i] }
  0 -> 1 when order[i]
  1 -> 0 when not order[i]
}
`;
const MAIN = `use 'lib/axis.g7'
use blink

instance Axis[1..2]

chart Main {
  initial step 10
  10 -> 10 when ↑order[1]
}

prove never Axis[1].X0 and Axis[1].X1
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
  folder = mkdtempSync(join(tmpdir(), 'g7-project-'));
  mkdirSync(join(folder, 'lib'));
  writeFileSync(join(folder, 'main.g7'), MAIN);
  writeFileSync(join(folder, 'lib/axis.g7'), AXIS);
  site = await serve(folder);
});

afterEach(async () => {
  await site.stop();
  rmSync(folder, { recursive: true, force: true });
});

const oneScan = async (p: Opened) => p.getByRole('button', { name: 'One scan', exact: true }).click();

async function end(p: Opened): Promise<void> {
  assert.deepEqual(p.errors, []);
  await p.context().close();
}

test('a chart of a used file is shown, runs, and is changed in its own file', async () => {
  const p = await open(b, site, 'main.g7');
  await p.getByRole('button', { name: /^Axis\(i\)/ }).click();
  await p.locator('[data-id="Axis/s/1"]').waitFor({ state: 'attached' });
  await oneScan(p);
  await p.getByRole('switch', { name: 'order[2]', exact: true }).click();
  await oneScan(p);
  const mark = () => p.locator('.live path.on').getAttribute('d');
  const first = await mark();
  await p.getByRole('button', { name: 'Axis[2]', exact: true }).click();
  await until(async () => (await mark()) !== first, 'the other instance stands in another step');
  // The drawing is not for changing here, and the way to its file is one click.
  await p.locator('.sheet').focus();
  await p.keyboard.press('ArrowDown');
  await p.keyboard.press('F2');
  await p.getByText('This chart stands in lib/axis.g7').first().waitFor();
  assert.equal(await p.locator('.inplace > input').count(), 0);
  await p.getByRole('button', { name: 'lib/axis.g7', exact: true }).click();
  await until(async () => (await p.getByRole('tab', { name: 'lib/axis.g7' }).getAttribute('aria-selected')) === 'true', 'its own file is shown');
  await end(p);
});

test('proofs and a shared run see the charts of used files', async () => {
  const p = await openWith(b, site, 'main.g7', { bottomOpen: true, bottom: 300 });
  await p.getByRole('tab', { name: /^Prove/ }).click();
  const claim = p.getByRole('listitem').filter({ has: p.getByRole('button', { name: 'prove never Axis[1].X0 and Axis[1].X1', exact: true }) }).first();
  await claim.getByText('proved:', { exact: true }).waitFor({ state: 'attached' });
  await p.getByRole('button', { name: /^Axis\(i\)/ }).click();
  await p.getByRole('switch', { name: 'Shared run' }).click();
  await p.locator('.clock').waitFor();
  await oneScan(p);
  await p.getByRole('switch', { name: 'order[1]', exact: true }).click();
  await oneScan(p);
  await until(async () => (await p.locator('.live path.on').count()) > 0, 'the run of the server marks the chart');
  await end(p);
});

test('what a used file becomes, here or on the disk, is seen by the file that uses it', async () => {
  const p = await open(b, site, 'main.g7');
  await p.getByRole('button', { name: /^Axis\(i\)/ }).waitFor();
  const bad = () => p.getByText('The chart has errors').count();
  assert.equal(await bad(), 0);
  writeFileSync(join(folder, 'lib/axis.g7'), AXIS.replace('not order[i]', 'not ordre[i]'));
  await until(async () => (await bad()) > 0, 'the mistake of the other file is one of this');
  writeFileSync(join(folder, 'lib/axis.g7'), AXIS);
  await until(async () => (await bad()) === 0, 'it is mended');
  await end(p);
});
