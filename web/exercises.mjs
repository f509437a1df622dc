// Writes the exercises into one file beside a built page: `node exercises.mjs MODULE FOLDER OUT`. The module of wasm makes of
// each folder what students get: texts, template and the hidden part sealed; the pictures of its plants stand beside that as they
// are. Solutions are not in it (decision 78).
import { readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const [module, folder, out] = process.argv.slice(2);
if (!module || !folder || !out) throw new Error('usage: node exercises.mjs MODULE FOLDER OUT');

const { instance } = await WebAssembly.instantiate(readFileSync(module), {});
const door = instance.exports;

function ask(message) {
  const bytes = Buffer.from(JSON.stringify(message));
  // The memory may grow, so the place comes first.
  const at = door.g7_reserve(bytes.length);
  new Uint8Array(door.memory.buffer, at, bytes.length).set(bytes);
  const length = door.g7_call();
  const answer = JSON.parse(Buffer.from(door.memory.buffer, door.g7_answer(), length).toString());
  if (answer.no !== undefined) throw new Error(answer.no);
  return answer.ok;
}

/** The laboratory of the bead sorter: its two preparations, then its four exercises. */
const LABORATORY = ['bead-sorter', 'bead-sorter-0-sorting', 'bead-sorter-1-both', 'bead-sorter-2-rest', 'bead-sorter-3-lamp', 'bead-sorter-4-patterns'];
/** The exercises from the first to the last that a student does; others come behind them. */
const ORDER = ['motor', 'cylinders', 'mixer', 'bottles', 'garage-door', 'pedestrian-light', 'press', 'carriages', 'emergency-stop', 'car-wash', ...LABORATORY];
const place = (id) => (ORDER.includes(id) ? ORDER.indexOf(id) : ORDER.length);

const entries = (path) => readdirSync(path, { withFileTypes: true }).sort((a, b) => (a.name < b.name ? -1 : 1));
const found = [];
for (const { name: id } of entries(folder).filter((entry) => entry.isDirectory())) {
  const text = (name) => readFileSync(join(folder, id, name), 'utf8');
  const names = entries(join(folder, id)).flatMap((entry) => (entry.isFile() ? [entry.name] : []));
  const files = names.filter((name) => /\.(g7|md)$/.test(name)).map((name) => ({ file: name, text: text(name) }));
  const pictures = Object.fromEntries(names.filter((name) => name.endsWith('.svg')).map((name) => [name, text(name)]));
  const packed = ask({ do: 'exercise_pack', folder: join(folder, id), files });
  // A plant without its picture still runs, so the student gets the exercise.
  const absent = packed.given ? ask({ do: 'open', file: `${id}.g7`, text: packed.given.template }).pictures.filter((name) => !(name in pictures)) : [];
  packed.faults.push(...absent.map((name) => ({ place: join(folder, id, 'template.g7'), what: `the picture ${name} is not in the folder` })));
  // The page tells them as well, and goes on with all others.
  for (const { place, what } of packed.faults) console.error(`${place}: error: ${what}`);
  found.push({ id, pictures, ...packed });
}
writeFileSync(out, JSON.stringify(found.sort((a, b) => place(a.id) - place(b.id))));
