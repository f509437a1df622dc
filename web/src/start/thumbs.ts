// Small pictures of files for the gallery, drawn by the same crates as the page: one after the
// other, and only those that become visible.
import { lent } from '../lib/files.svelte';
import { page } from '../lib/page';
import type { Box } from '../lib/protocol';
import { drawn, svgOf } from '../lib/redrawn';
import { server, type FileRow } from '../lib/server';

export interface Thumb {
  /** The first sentence of the notes at the head of the file. */
  about: string;
  svg: string;
  area: Box;
  steps: number;
  tests: number;
  plant: boolean;
}

/** Calls a function once, when an element comes near the visible part of the page; returns the end of the wait. */
export function whenSeen(element: HTMLElement, then: () => void): () => void {
  const sight = new IntersectionObserver(
    (entries) => {
      if (!entries.some((e) => e.isIntersecting)) return;
      sight.disconnect();
      then();
    },
    { rootMargin: '200px' },
  );
  sight.observe(element);
  return () => sight.disconnect();
}

const known = new Map<string, Promise<Thumb>>();
let last: Promise<unknown> = Promise.resolve();

/** The picture of a file of the gallery. */
export function thumb(row: FileRow): Promise<Thumb> {
  return queued(`${row.path}\n${row.hash}`, row.path, async () => (await server.read(row.path)).text);
}

/** The picture of a text, made when its turn comes; `key` is another one for another text. */
export function queued(key: string, path: string, read: () => Promise<string>): Promise<Thumb> {
  let found = known.get(key);
  if (!found) {
    found = last.then(async () => picture(path, await read()));
    last = found.catch(() => undefined);
    known.set(key, found);
  }
  return found;
}

async function picture(path: string, text: string): Promise<Thumb> {
  const prefix = '\u0000gallery/';
  const { file, charts, tests, plants } = await lent(await page.call({ do: 'open', file: prefix + path, text }), prefix);
  try {
    const own = charts.filter((c) => !c.of && c.kind === 'chart');
    const chart = own[0] ?? charts[0];
    const drawing = chart ? await drawn({ file, chart: chart.name }) : null;
    return {
      about: about(text),
      svg: drawing?.items.map(svgOf).join('') ?? '',
      area: drawing?.area ?? [0, 0, 1, 1],
      steps: charts.reduce((n, c) => n + c.steps, 0),
      tests: tests.length,
      plant: plants.length > 0,
    };
  } finally {
    void page.call({ do: 'close', file }).catch(() => undefined);
  }
}

function about(text: string): string {
  const lines: string[] = [];
  for (const line of text.split('\n')) {
    const note = /^\s*\/\/ ?(.*)/.exec(line)?.[1];
    if (note === undefined || note.trim() === '') break;
    lines.push(note);
  }
  return lines.join(' ');
}

const LEAST = 400;
const MOST = 560;

/** The part of a drawing that is shown: its beginning, at a readable size. */
export function crop([x, y, w, h]: Box): string {
  const width = Math.min(Math.max(w + 40, LEAST), MOST);
  const height = width * 0.62;
  const left = w + 40 > MOST ? x - 20 : x - (width - w) / 2;
  const top = h + 40 < height ? y - (height - h) / 2 : y - 20;
  return [left, top, width, height].map((n) => n.toFixed(1)).join(' ');
}
