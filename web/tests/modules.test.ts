// The two modules of wasm without a page round them: the first answers what it contains and sends to the second for
// the rest; the second answers about a file that it is lent as the whole program answers about one that it has open.
import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { before, test } from 'node:test';

const HERE = new URL('..', import.meta.url).pathname;
const DIST = resolve(process.env.G7_DIST ?? join(HERE, 'dist'));
const FILES = join(HERE, '../tests/interchange');

type Message = { do: string } & Record<string, unknown>;
type Answer = { ok?: unknown; no?: string; elsewhere?: { as: string; files: { file: string; text: string }[] } };
type Call = (message: object) => Answer;

/** A module of its own, with one page. */
async function load(name: string): Promise<Call> {
  const { instance } = await WebAssembly.instantiate(readFileSync(join(DIST, name)), {});
  const door = instance.exports as { memory: WebAssembly.Memory; g7_reserve(n: number): number; g7_call(): number; g7_answer(): number };
  return (message) => {
    const bytes = Buffer.from(JSON.stringify(message));
    // The memory may grow, so the place comes first.
    const at = door.g7_reserve(bytes.length);
    new Uint8Array(door.memory.buffer, at, bytes.length).set(bytes);
    const length = door.g7_call();
    return JSON.parse(Buffer.from(door.memory.buffer, door.g7_answer(), length).toString()) as Answer;
  };
}

const CHART = `input a, b : BOOL
output M : BOOL
chart G {
  initial step 1
  step 2 { N M }
  1 -> 2 when a
  1 -> 1 when b
  2 -> 1 when not a
}

plant Tank {
  state level : REAL in 0.0 .. 9.0
  drive b := level > 5.0
  view 'tank.svg' { water.level := level / 9.0 }
}

test "on" {
  set a := TRUE
  expect M
}
`;

let first: Call;
let whole: Call;

before(async () => {
  first = await load('g7.wasm');
  whole = await load('g7-whole.wasm');
});

/** The answer that the page gets: as in `src/lib/page.ts`. */
function asked(message: Message): Answer {
  const answer = first(message);
  if (!answer.elsewhere) return answer;
  const { as, files } = answer.elsewhere;
  const there = whole({ between: as, files, ask: message });
  return as === 'import' && there.no === undefined ? first(there.ok as object) : there;
}

const RARE: Message[] = [
  { do: 'forms' },
  ...['c', 'rust', 'st', 'plcopen', 'sfc', 'mermaid', 'svg', 'nothing'].map((to) => ({ do: 'export', file: 'a.g7', to })),
  { do: 'prove', file: 'a.g7', states: 1000, mib: 64 },
  { do: 'test', file: 'a.g7' },
  { do: 'test_why', file: 'a.g7', name: 'goes on' },
  { do: 'logic', file: 'a.g7', id: 'G/t/0', tongue: 'il' },
  { do: 'logic', file: 'a.g7', id: 'G/t/0', tongue: 'ld' },
  { do: 'prove_ways', file: 'a.g7', hash: 'of no text', question: 0, run: [] },
  { do: 'compare', files: ['a.g7', 'a.g7'], profiles: [null, 'iec61131'], states: 1000, mib: 64 },
  { do: 'sheets', file: 'a.g7', paper: 'a4', charts: ['G'], dossier: true, head: { title: '', author: '', company: '', revision: '', date: '' }, pictures: [] },
  { do: 'plant_picture', file: 'a.g7', plant: 'Tank' },
  { do: 'plant_picture', file: 'a.g7', plant: 'none' },
  { do: 'logic_read', tongue: 'il', text: 'LD a' },
  { do: 'merge', base: CHART, mine: CHART, theirs: `${CHART}// more\n` },
  { do: 'exercise_pack', folder: 'on', files: [{ file: 'statement.md', text: '# On\n' }, { file: 'template.g7', text: CHART }, { file: 'model.g7', text: CHART }] },
  { do: 'exercise_check', name: 'a.g7', text: CHART, exercise: { template: CHART, uses: [], sealed: '' }, states: 100 },
];

test('what the first module does not contain is answered as by the whole program', async () => {
  const alone = await load('g7-whole.wasm');
  for (const call of [first, alone]) call({ do: 'open', file: 'a.g7', text: CHART });
  for (const message of RARE) {
    assert.ok(first(message).elsewhere, `${message.do} is not in the first module`);
    const said = asked(message);
    assert.deepEqual(said, alone(message), JSON.stringify(message));
    assert.equal(said.elsewhere, undefined);
  }
  assert.match(first({ do: 'export', file: 'none.g7', to: 'c' }).no ?? '', /none.g7 is not open/);
  assert.equal(whole({ do: 'text', file: 'a.g7' }).ok, undefined, 'what was lent is forgotten');
});

test('the first module shows, edits and runs by itself', () => {
  const messages: Message[] = [
    { do: 'open', file: 'a.g7', text: CHART },
    { do: 'drawing', file: 'a.g7', chart: 'G' },
    { do: 'edit', file: 'a.g7', gesture: { g: 'next', id: 'G/s/2' } },
    { do: 'undo', file: 'a.g7' },
    { do: 'splice', file: 'a.g7', splices: [{ from: 0, to: 0, insert: ' ' }] },
    { do: 'format', file: 'a.g7' },
    { do: 'complete', file: 'a.g7', at: 40 },
    { do: 'hover', file: 'a.g7', at: 7 },
    { do: 'tokens', file: 'a.g7' },
    { do: 'symbols', file: 'a.g7' },
    { do: 'search', file: 'a.g7', text: 'M' },
    { do: 'logic', file: 'a.g7', id: 'G/t/0', tongue: 'st' },
    { do: 'run_start', file: 'a.g7', run: 'r', moves: [{ wait_ns: 0, set: [[0, '1']] }] },
    { do: 'run_advance', run: 'r', ms: 100 },
    { do: 'run_export', run: 'r', as: 'vcd', signals: [0] },
    { do: 'speak', language: 'fr' },
    { do: 'look', file: 'a.g7' },
    { do: 'close', file: 'a.g7' },
  ];
  for (const message of messages) assert.ok('ok' in first(message), `${message.do}: ${JSON.stringify(first(message))}`);
});

test('files of other tools are opened as by the whole program', async () => {
  const alone = await load('g7-whole.wasm');
  const paths = readdirSync(FILES, { recursive: true, encoding: 'utf8' }).filter((path) => /\.\w+$/.test(path) && !/\.(md|txt)$/.test(path));
  let foreign = 0;
  for (const path of paths) {
    const name = path.slice(path.lastIndexOf('/') + 1);
    const message = { do: 'open', file: name, text: readFileSync(join(FILES, path), 'utf8') };
    const sent = first(message).elsewhere !== undefined;
    const [here, there] = [asked(message), alone(message)];
    assert.deepEqual(here, there, path);
    const look = there.ok as { imported: boolean; file: string } | undefined;
    assert.equal(sent, look ? look.imported : true, `${path}: a file of another tool, or one of ours`);
    foreign += Number(look?.imported ?? false);
    if (!look) continue;
    assert.deepEqual(first({ do: 'text', file: look.file }), alone({ do: 'text', file: look.file }), path);
    for (const call of [first, alone]) call({ do: 'close', file: look.file });
  }
  assert.ok(foreign > 20, `${foreign} files of other tools`);
});
