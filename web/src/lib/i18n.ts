// One table of words: key -> [English, French, Portuguese].
import { access } from './words/access';
import { canvas } from './words/canvas';
import { exercise } from './words/exercise';
import { out } from './words/export';
import { course } from './words/course';
import { gone } from './words/gone';
import { names } from './words/names';
import { operator } from './words/operator';
import { panels } from './words/panels';
import { prove } from './words/prove';
import { run } from './words/run';
import { share } from './words/share';
import { shell } from './words/shell';
import { start } from './words/start';
import { text } from './words/text';
import { why } from './words/why';
import { wiring } from './words/wiring';
import { work } from './words/work';
import { prefs } from './prefs.svelte';

export type Words = Record<string, readonly [en: string, fr: string, pt: string]>;

