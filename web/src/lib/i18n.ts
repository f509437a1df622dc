// One table of words: key -> [English, French, Portuguese].
import { access } from './words/access';
import { canvas } from './words/canvas';
import { out } from './words/export';
import { course } from './words/course';
import { exercise } from './words/exercise';
import { gone } from './words/gone';
import { names } from './words/names';
import { operator } from './words/operator';
import { panels } from './words/panels';
import { picture } from './words/picture';
import { print } from './words/print';
import { prove } from './words/prove';
import { run } from './words/run';
import { share } from './words/share';
import { shell } from './words/shell';
import { start } from './words/start';
import { text } from './words/text';
import { together } from './words/together';
import { why } from './words/why';
import { wiring } from './words/wiring';
import { work } from './words/work';
import { prefs } from './prefs.svelte';

export type Words = Record<string, readonly [en: string, fr: string, pt: string]>;

const table = { ...access, ...shell, ...canvas, ...course, ...exercise, ...out, ...gone, ...names, ...operator, ...panels, ...picture, ...print, ...prove, ...run, ...share, ...start, ...text, ...together, ...why, ...wiring, ...work } as const;

export type Key = keyof typeof table;
export type Language = 'en' | 'fr' | 'pt';

export const languages: Record<Language, string> = { en: 'English', fr: 'Français', pt: 'Português' };

/** The sentence in the language of the page. */
export function said(row: readonly [en: string, fr: string, pt: string]): string {
  const at = { en: 0, fr: 1, pt: 2 } as const;
  return row[at[prefs.language]];
}

/** The word in the language of the page; `{name}` is replaced by a value. */
export function t(key: Key, values: Record<string, string | number> = {}): string {
  return said(table[key]).replace(/\{(\w+)\}/g, (whole, name: string) => String(values[name] ?? whole));
}
