// The answers to all questions about the visible file, and their marks on the drawing. A worker of
// its own searches, so that gestures are answered meanwhile; it is ended where it takes too long.
import { files, type OpenFile } from './files.svelte';
import { Local } from './page';
import type { ProofReport, ProofRow } from './protocol';
import { runs, type Run } from './runs.svelte';

/** The worker has one file, whichever that is. */
const FILE = 'asked.g7';
/** The limits of the search while the user types, in states, and its longest time in ms. */
const QUICK: readonly number[] = [25, 250, 1_000, 4_000];
const QUICK_TIME = 3_000;
/** The same for the search that the user asks for. */
const WHOLE: readonly number[] = [16_000, 64_000, 256_000, 1_000_000];
const WHOLE_TIME = 120_000;
const MEMORY = 256;
/** The questions of a file with more steps are asked on request only. */
export const LARGE = 300;

export interface Proof extends ProofReport {
  /** States up to which it was searched. */
  states: number;
  /** The user has asked for more than the quick search. */
  whole: boolean;
}

/** What the worker does now. */
interface Work {
  file: string;
  hash: string;
  whole: boolean;
  states: number;
}

/** The subject of a run that is shown: an answer, or the failure of a test of an exercise, whose number is below 0. */
export type Played = Pick<ProofRow, 'number' | 'claim' | 'run' | 'id' | 'blame'>;

/** An answer whose run is shown on the chart. */
export interface Shown {
  row: Played;
  hash: string;
  run: Run;
  /** The run that it replaced moved. */
  moved: boolean;
  /** There was a run before. */
  had: boolean;
}

const none: ReadonlySet<string> = new Set();

class Proofs {
  #byFile: ReadonlyMap<string, Proof> = $state.raw(new Map());
  work: Work | null = $state.raw(null);
  failed = $state('');
  /** The text whose search took too long. */
  cut = $state('');
  shown: Shown | null = $state.raw(null);
  /** The page asks by itself: from the first change of a text on, or once the panel was open. Whoever only looks at
   * charts loads no module for it. */
  begun = $state(false);
  #worker = new Local('g7-whole.wasm');
  /** The hash of the text that the worker has. */
  #opened = '';
  #turn = 0;

  /** The latest answers of the visible file. */
  readonly latest: Proof | null = $derived(files.current ? (this.#byFile.get(files.current.name) ?? null) : null);
  /** The same, if they are about the present text. */
  readonly present: Proof | null = $derived(this.latest && this.latest.hash === files.current?.look.hash ? this.latest : null);
  /** The answer whose run the visible file shows. */
  readonly playing: Shown | null = $derived(this.shown && runs.current === this.shown.run ? this.shown : null);

  /** The symbols that no run reaches. */
  readonly dead: ReadonlySet<string> = $derived.by(() => {
    const rows = this.present?.rows.filter((r) => r.verdict === 'refuted' && r.id) ?? [];
    return rows.length > 0 ? new Set(rows.map((r) => r.id as string)) : none;
  });
  /** The steps and transitions of the conflict that was found. */
  readonly conflict: ReadonlySet<string> = $derived.by(() => {
    const row = this.present?.rows.find((r) => r.about === 'conflict' && r.verdict === 'refuted');
    return row?.blame ? new Set(row.blame) : none;
  });
  /** The symbols that the shown run is about. */
  readonly guilty: ReadonlySet<string> = $derived.by(() => {
    const shown = this.playing;
    if (!shown || shown.hash !== files.current?.look.hash) return none;
    return new Set(shown.row.blame ?? (shown.row.id ? [shown.row.id] : []));
  });

  /** Asks all questions as far as is quick; the answers of other texts wait no longer. */
  quick(file: OpenFile): Promise<void> {
    const known = this.#byFile.get(file.name);
    const { hash } = file.look;
    if (known?.hash === hash || this.work?.hash === hash || this.cut === hash) return Promise.resolve();
    return this.#search(file, QUICK, QUICK_TIME, false);
  }

  /** Searches on for what is open. */
  whole(file: OpenFile): Promise<void> {
    return this.#search(file, [...QUICK, ...WHOLE], WHOLE_TIME, true);
  }

  /** Ends the search; what was found stays. */
  stop(): void {
    this.#turn++;
    if (this.work) this.#end();
    this.work = null;
  }

  #end(): void {
    this.#worker.stop();
    this.#opened = '';
  }

  async #search(file: OpenFile, rounds: readonly number[], time: number, whole: boolean): Promise<void> {
    this.stop();
    const turn = ++this.#turn;
    const mine = () => turn === this.#turn;
    await file.settled();
    if (!mine()) return;
    const { hash } = file.look;
    this.failed = '';
    this.work = { file: file.name, hash, whole, states: 0 };
    let late = 0;
    try {
      if (this.#opened !== hash) await this.#worker.call({ do: 'open', file: FILE, text: file.text, uses: await file.used() });
      if (!mine()) return;
      this.#opened = hash;
      late = window.setTimeout(() => {
        if (!mine()) return;
        this.cut = hash;
        this.stop();
      }, time);
      const from = this.#byFile.get(file.name);
      for (const states of rounds) {
        if (from?.hash === hash && states < from.states) continue;
        this.work = { file: file.name, hash, whole, states };
        const report = await this.#worker.call({ do: 'prove', file: FILE, states, mib: MEMORY });
        if (!mine()) return;
        this.#put(file.name, { ...report, hash, states, whole });
        if (report.refused || !report.rows.some((r) => r.verdict === 'open')) break;
      }
    } catch (error) {
      if (mine()) this.failed = (error as Error).message;
    } finally {
      clearTimeout(late);
      if (mine()) this.work = null;
    }
  }

  #put(file: string, proof: Proof): void {
    this.#byFile = new Map(this.#byFile).set(file, proof);
  }

  /** The text that was asked, by its hash. */
  asked(file: OpenFile): string {
    return this.#byFile.get(file.name)?.hash ?? '';
  }

  /** Shows the run of an answer about a text of this hash on the chart, in the place of the file's run. */
  async play(file: OpenFile, row: Played, hash: string): Promise<Run | null> {
    if (!row.run || hash !== file.look.hash) return null;
    const [before, again] = [runs.of(file.name), this.shown];
    const kept = again && before === again.run ? { had: again.had, moved: again.moved } : { had: before !== null, moved: before?.playing ?? false };
    const run = await runs.repeat(file, row.run);
    this.shown = { row, hash, run, ...kept };
    return run;
  }

  /** Ends the shown run; the file's own begins anew if there was one. */
  async back(file: OpenFile): Promise<void> {
    const { shown } = this;
    this.shown = null;
    if (!shown || runs.of(file.name) !== shown.run) return;
    if (!shown.had) await runs.stop(file.name);
    else await runs.play(await runs.start(file), shown.moved);
  }
}

export const proofs = new Proofs();
