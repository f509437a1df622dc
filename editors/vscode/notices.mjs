// The licences of what is bundled into the extension: the packages of the lock that are no tools.

import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';

/** Each bundled package with its licence, as one text. */
export function notices(here) {
  const lock = JSON.parse(readFileSync(join(here, 'package-lock.json'), 'utf8'));
  const parts = ['The extension contains these packages.\n'];
  for (const [path, about] of Object.entries(lock.packages).sort()) {
    if (path === '' || about.dev || !existsSync(join(here, path))) continue;
    const file = readdirSync(join(here, path)).find((name) => /^licen[cs]e/i.test(name));
    if (file === undefined) throw new Error(`${path} has no licence`);
    const text = readFileSync(join(here, path, file), 'utf8').trim();
    parts.push(`${path.replace(/^.*node_modules\//, '')} ${about.version} (${about.license})\n\n${text}\n`);
  }
  return parts.join(`\n${'-'.repeat(80)}\n\n`);
}
