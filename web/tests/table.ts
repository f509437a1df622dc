// The words of the page, as rows in English, French and Portuguese.
import { canvas } from '../src/lib/words/canvas';
import { out } from '../src/lib/words/export';
import { names } from '../src/lib/words/names';
import { panels } from '../src/lib/words/panels';
import { prove } from '../src/lib/words/prove';
import { run } from '../src/lib/words/run';
import { share } from '../src/lib/words/share';
import { shell } from '../src/lib/words/shell';
import { start } from '../src/lib/words/start';
import { text } from '../src/lib/words/text';
import { work } from '../src/lib/words/work';

export const words: readonly (readonly [en: string, fr: string, pt: string])[] = [canvas, out, names, panels, prove, run, share, shell, start, text, work].flatMap((part) => Object.values(part));
