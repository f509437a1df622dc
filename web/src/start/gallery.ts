// The order and the headings of the gallery.
import { isChart } from '../lib/charts';
import { t, type Key } from '../lib/i18n';
import { base } from '../lib/paths';
import type { FileRow } from '../lib/server';

const FOLDERS: [string, Key][] = [
  ['bead-sorter', 'start.folder.beadSorter'],
  ['bottle-conveyor', 'start.folder.bottleConveyor'],
  ['two-tanks', 'start.folder.twoTanks'],
  ['transport-workcell', 'start.folder.workcell'],
  ['structure', 'start.folder.structure'],
  ['actions', 'start.folder.actions'],
  ['modelling', 'start.folder.modelling'],
  ['parts', 'start.folder.parts'],
];

export interface Group {
  title: string;
  rows: { row: FileRow; name: string }[];
}

const plain = (name: string) => {
  const words = name.replace(/\.\w+$/, '').replace(/[-_]+/g, ' ');
  return words.charAt(0).toUpperCase() + words.slice(1);
};

export function groups(rows: FileRow[]): Group[] {
  const found = new Map<string, FileRow[]>();
  for (const row of rows) {
    if (!isChart(row.path)) continue;
    const folder = row.path.slice(0, Math.max(row.path.lastIndexOf('/'), 0));
    found.set(folder, [...(found.get(folder) ?? []), row]);
  }
  const rank = (folder: string) => {
    const at = FOLDERS.findIndex(([name]) => folder.split('/').at(-1) === name);
    return at < 0 ? (folder === '' ? -1 : FOLDERS.length) : at;
  };
  return [...found]
    .sort(([a], [b]) => rank(a) - rank(b) || (a < b ? -1 : 1))
    .map(([folder, of]) => {
      const key = FOLDERS.find(([name]) => folder.split('/').at(-1) === name)?.[1];
      const title = key ? t(key) : folder ? plain(folder) : t('start.files');
      return { title, rows: of.map((row) => ({ row, name: label(row, title) })) };
    });
}

/** A file named `chart` gets the name of its folder. */
function label(row: FileRow, folder: string): string {
  const name = base(row.path);
  return name === 'chart.g7' && folder ? folder : plain(name);
}

/** The name of a file in a short list. */
export function short(path: string): string {
  const parts = path.split('/');
  const name = plain(parts.at(-1) ?? path);
  return parts.length > 1 ? `${plain(parts.at(-2) ?? '')} · ${name}` : name;
}
