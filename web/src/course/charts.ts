// The charts that the chapters show: those of the course, and those of the examples, each a part of the page that is fetched when it
// is shown. So a chapter works in any folder, and without a server.
import { base } from '../lib/paths';
import type { Leaf, Parcel } from '../share/links';

const own = import.meta.glob<string>('../../../course/*/*.g7', { query: '?raw', import: 'default' });
const examples = import.meta.glob<string>(['../../../examples/{actions,bead-sorter,bottle-conveyor,modelling,structure,transport-workcell,two-tanks}/*.{g7,svg}', '!../../../examples/bead-sorter/{chart,exercise-*}.g7'], { query: '?raw', import: 'default' });

/** Where the examples lie, seen from a chapter. */
const EXAMPLES = '../../examples/';

/** The name under which a chart of a chapter is opened: an example keeps its place in the folder of examples. */
export const nameOf = (href: string): string => (href.startsWith(EXAMPLES) ? href.slice(EXAMPLES.length) : `course/${base(href)}`);

/** The chart that a chapter names, with the pictures of its plants. */
export async function chartOf(chapter: string, href: string): Promise<Parcel> {
  const example = href.startsWith(EXAMPLES);
  const read = example ? examples[`../${href}`] : own[`../../../course/${chapter}/${href}`];
  if (!read) throw new Error(`${chapter}: ${href}`);
  return { file: nameOf(href), text: await read(), uses: [], pictures: example ? await pictures(href) : [] };
}

function pictures(href: string): Promise<Leaf[]> {
  const folder = `../${href.slice(0, href.lastIndexOf('/') + 1)}`;
  const found = Object.entries(examples).filter(([path]) => path.startsWith(folder) && path.endsWith('.svg'));
  return Promise.all(found.map(async ([path, read]) => ({ file: nameOf(path.slice('../'.length)), text: await read() })));
}
