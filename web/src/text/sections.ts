// The sections of a file, as targets for jumps.
import type { Key } from '../lib/i18n';
import type { Look } from '../lib/protocol';

export interface Group {
  title: Key;
  rows: { name: string; at: number }[];
}

export function sections(look: Look, text: string): Group[] {
  const plants = look.plants.map((name) => ({ name, at: Math.max(0, text.search(new RegExp(`^\\s*plant\\s+\`?${escaped(name)}`, 'm'))) }));
  const groups: Group[] = [
    { title: 'app.charts', rows: look.charts.filter((c) => !c.file).map((c) => ({ name: c.name, at: c.from })) },
    { title: 'text.plants', rows: plants },
    { title: 'text.tests', rows: look.tests.map((test) => ({ name: test.name, at: test.from })) },
  ];
  return groups.filter((g) => g.rows.length > 0);
}

const escaped = (name: string) => name.replace(/[.*+?^${}()|[\]\\]/g, '\\$&');
