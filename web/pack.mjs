// Compresses the files of a folder into another one: each as gzip (`name.gz`) and as Brotli (`name.br`).
// `node pack.mjs` makes `packed` of the built page, from where it goes into the `g7` binary;
// `node pack.mjs site site` puts both forms beside the files of the playground, where web servers look
// for them. With `WASM=quick-wasm` it takes little time rather than little room.
import { mkdirSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { brotliCompressSync, constants, gzipSync } from 'node:zlib';

const [from = 'dist', to = 'packed'] = process.argv.slice(2);
const quick = process.env.WASM === 'quick-wasm';
const paths = readdirSync(from, { recursive: true }).filter((path) => statSync(join(from, path)).isFile() && !/\.(gz|br)$/.test(path));
if (resolve(from) !== resolve(to)) rmSync(to, { recursive: true, force: true });
for (const path of paths) {
  const bytes = readFileSync(join(from, path));
  const packed = join(to, path);
  mkdirSync(dirname(packed), { recursive: true });
  writeFileSync(`${packed}.gz`, gzipSync(bytes, { level: quick ? 1 : 9 }));
  const params = {
    [constants.BROTLI_PARAM_QUALITY]: quick ? 2 : constants.BROTLI_MAX_QUALITY,
    [constants.BROTLI_PARAM_LGWIN]: constants.BROTLI_MAX_WINDOW_BITS,
    [constants.BROTLI_PARAM_SIZE_HINT]: bytes.length,
  };
  const brotli = brotliCompressSync(bytes, { params });
  writeFileSync(`${packed}.br`, brotli);
  if (!quick && path.endsWith('.wasm')) console.log(`${path}: ${(brotli.length / 1e6).toFixed(3)} MB as Brotli`);
}
