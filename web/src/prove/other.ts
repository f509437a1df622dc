// The two sides of a comparison, by the choice of the user.
import type { Side } from '../lib/compared.svelte';
import { files, lent, type OpenFile } from '../lib/files.svelte';
import { t } from '../lib/i18n';
import { page, Refused } from '../lib/page';
import { base } from '../lib/paths';
import type { Form } from '../lib/protocol';
import { server } from '../lib/server';

/** The forms that are read back. */
let known: Promise<Form[]> | undefined;
export function forms(): Promise<Form[]> {
  known ??= page.call({ do: 'forms' }).then((all) => all.filter((f) => f.read));
  return known;
}

/** A file that is not open, with those that it uses. */
async function read(path: string): Promise<Pick<Side, 'text' | 'uses'>> {
  const { text } = await server.read(path);
  const prefix = '\u0000other/';
  const { file } = await lent(await page.call({ do: 'open', file: prefix + path, text }), prefix);
  const uses = await page.call({ do: 'used', file });
  await page.call({ do: 'close', file });
  return { text, uses };
}

/** The visible file, and what is chosen: `profile:…`, `before`, `form:…` or `file:…`. */
export async function sides(file: OpenFile, choice: string): Promise<readonly [Side, Side]> {
  await file.settled();
  const { profile } = file.look;
  const name = base(file.name);
  const mine: Side = { title: name, name, text: file.text, uses: await file.used(), profile: null };
  const at = choice.indexOf(':');
  const [sort, what] = at < 0 ? [choice, ''] : [choice.slice(0, at), choice.slice(at + 1)];
  if (sort === 'profile') return [{ ...mine, title: profile, profile }, { ...mine, title: what, profile: what }];
  if (sort === 'before') {
    const { text } = await page.call({ do: 'before', file: file.name });
    if (text === null) throw new Refused(t('compare.nothing'));
    return [{ ...mine, title: t('compare.before'), text }, mine];
  }
  if (sort === 'form') {
    const made = await page.call({ do: 'export', file: file.name, to: what });
    const out = made.files.at(-1);
    if (!out) throw new Refused(t('compare.unwritten'));
    return [mine, { title: base(out.name), name: base(out.name), text: out.text, uses: [], profile: null }];
  }
  const open = files.find(what);
  await open?.settled();
  const other = open ? { text: open.text, uses: await open.used() } : await read(what);
  return [mine, { title: base(what) === name ? what : base(what), name: base(what), ...other, profile: null }];
}
