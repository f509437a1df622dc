// The tour through a first chart: the lessons, and how each is recognized as done. It observes the
// file, the drawing and the run, and advances by itself.
import { editor } from '../canvas/editor.svelte';
import { files } from '../lib/files.svelte';
import type { Key } from '../lib/i18n';
import { live } from '../lib/live.svelte';
import { prefs } from '../lib/prefs.svelte';
import { runs } from '../lib/runs.svelte';
import { shell } from '../lib/shell.svelte';

export interface Lesson {
  title: Key;
  what: Key;
  /** The keys for the lesson. */
  keys?: string[];
  done: () => boolean;
  /** Makes everything visible that the lesson needs. */
  prepare?: () => void;
}

const NAME = 'first-chart.g7';
const FIRST = '// My first chart.\nchart G1 {\n  initial step 0\n}\n';

const look = () => files.current?.look;
const chart = () => look()?.charts[0];
const items = (part: string) => editor.scene?.items.filter((i) => i.part === part) ?? [];
const receptivities = () => items('transition').map((i) => (i.source ?? '').trim());
const errors = () => look()?.problems.some((p) => p.severity === 'error') ?? true;
const declared = (kind: string) => new RegExp(`^\\s*${kind}\\s`, 'm').test(files.current?.text ?? '') && !errors();
const second = () => {
  const initial = items('step').find((i) => i.initial)?.id;
  return [...live.on].some((id) => id !== initial && /\/s\//.test(id));
};

function problems(): void {
  prefs.bottomOpen = true;
  shell.tabs.bottom = 'problems';
}

export const lessons: Lesson[] = [
  {
    title: 'tour.step',
    what: 'tour.step.what',
    done: () => [...shell.selection].some((id) => /\/s\//.test(id)),
  },
  {
    title: 'tour.next',
    what: 'tour.next.what',
    keys: ['Tab'],
    done: () => (chart()?.steps ?? 0) >= 2 && (chart()?.transitions ?? 0) >= 1,
  },
  {
    title: 'tour.receptivity',
    what: 'tour.receptivity.what',
    keys: ['↑start', 'Enter'],
    done: () => receptivities().some((r) => r !== '' && !/^(=?1|true)$/i.test(r)),
  },
  { title: 'tour.input', what: 'tour.input.what', prepare: problems, done: () => declared('input') },
  {
    title: 'tour.action',
    what: 'tour.action.what',
    keys: ['A', 'N lamp', 'Enter'],
    done: () => items('action').length > 0,
  },
  { title: 'tour.output', what: 'tour.output.what', prepare: problems, done: () => declared('output') },
  {
    title: 'tour.back',
    what: 'tour.back.what',
    keys: ['J', 'Enter'],
    done: () => (chart()?.transitions ?? 0) >= 2,
  },
  {
    title: 'tour.time',
    what: 'tour.time.what',
    keys: ['3s/X1', 'Enter'],
    done: () => receptivities().some((r) => /\d\s*(ms|s|m)?\s*\/\s*X/.test(r)) && !errors(),
  },
  { title: 'tour.run', what: 'tour.run.what', keys: ['Space'], done: () => runs.current?.playing ?? false },
  {
    title: 'tour.press',
    what: 'tour.press.what',
    prepare: () => {
      prefs.rightOpen = true;
      prefs.bottomOpen = false;
      shell.tabs.right = 'operate';
    },
    done: second,
  },
];

class Tour {
  /** The number of the lesson; null if the tour is not running. */
  at: number | null = $state(null);
  /** The file of the tour. */
  file: string | null = $state(null);

  get lesson(): Lesson | null {
    return this.at === null ? null : (lessons[this.at] ?? null);
  }

  get over(): boolean {
    return this.at !== null && this.at >= lessons.length;
  }

  async begin(): Promise<void> {
    const known = files.find(NAME);
    if (known) await shell.try(() => files.close(known));
    const file = await shell.try(() => files.open(NAME, FIRST));
    if (!file) return;
    shell.gallery = false;
    shell.select([]);
    prefs.view = 'chart';
    this.file = file.name;
    this.to(0);
  }

  to(at: number): void {
    this.at = Math.max(0, at);
    const prepare = this.lesson?.prepare;
    if (!prepare) return;
    prepare();
    // By then the regions have their new sizes.
    setTimeout(() => editor.camera?.fit(), 60);
  }

  end(): void {
    this.at = null;
    prefs.guided = true;
  }
}

export const tour = new Tour();
