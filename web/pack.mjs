// Compresses the built page into `packed`, from where it goes into the `g7` binary: each file as gzip
// under its own name. A wasm module shrinks to a third.
import { mkdirSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { gzipSync } from 'node:zlib';

rmSync('packed', { recursive: true, force: true });
for (const path of readdirSync('dist', { recursive: true })) {
  const built = join('dist', path);
  if (!statSync(built).isFile()) continue;
  const packed = join('packed', path);
  mkdirSync(dirname(packed), { recursive: true });
  writeFileSync(packed, gzipSync(readFileSync(built), { level: 9 }));
}
