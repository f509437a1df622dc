// Compresses the built page into `packed`, from where it goes into the `g7` binary: each file as gzip
// under its own name. A wasm module shrinks to a third.
import { mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, join, relative } from 'node:path';
import { gzipSync } from 'node:zlib';

rmSync('packed', { recursive: true, force: true });
for (const entry of readdirSync('dist', { recursive: true, withFileTypes: true })) {
  if (!entry.isFile()) continue;
  const path = join(entry.parentPath, entry.name);
  const packed = join('packed', relative('dist', path));
  mkdirSync(dirname(packed), { recursive: true });
  writeFileSync(packed, gzipSync(readFileSync(path), { level: 9 }));
}
