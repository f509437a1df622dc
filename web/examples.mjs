// Writes all examples into one file beside a built page: `node examples.mjs FOLDER OUT`.
import { readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join, relative } from 'node:path';

const [folder, out] = process.argv.slice(2);
if (!folder || !out) throw new Error('usage: node examples.mjs FOLDER OUT');

const found = {};
for (const entry of readdirSync(folder, { recursive: true, withFileTypes: true })) {
  if (!entry.isFile() || !/\.(g7|svg|md)$/.test(entry.name)) continue;
  const path = join(entry.parentPath, entry.name);
  found[relative(folder, path).split('\\').join('/')] = readFileSync(path, 'utf8');
}
const sorted = Object.fromEntries(Object.entries(found).sort(([a], [b]) => (a < b ? -1 : 1)));
writeFileSync(out, JSON.stringify(sorted));
