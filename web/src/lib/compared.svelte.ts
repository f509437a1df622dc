// A comparison for every sequence of inputs: the visible file beside another one, itself under another
// profile, an earlier text, or what is read back from an export. A worker of its own searches; the runs
// that tell them apart are repeated in the page.
import type { Lane } from '../run/lanes';
import { Run } from '../run/state.svelte';
import { files, type OpenFile } from './files.svelte';
import { Local, page } from './page';
import type { ComparedReport, Look, ProofScan, Shelved } from './protocol';

/** Limits of the search one after the other, in pairs of states, and its longest time in ms. */
const ROUNDS: readonly number[] = [1_000, 16_000, 64_000, 256_000, 1_000_000];
const TIME = 120_000;
const MEMORY = 256;
/** A scan is seen so long while the runs play, in ms; less where they are long. */
const SEEN = 500;
const WHOLE = 6_000;

/** A chart of a comparison. */
export interface Side {
  title: string;
  /** The name decides how the text is read. */
  name: string;
  text: string;
  /** The texts of the files that it uses. */
  uses: Shelved[];
  /** Null: that of the text, whose rules belong to what is compared. */
  profile: string | null;
}

/** A side with its run up to the first difference. */
export interface Told {
  side: Side;
  look: Look;
  run: Run;
  /** Inputs, outputs and steps over the whole run. */
  lanes: readonly Lane[];
}

class Comparison {
  /** The name of the visible file that is compared, and its text. */
  file = $state('');
  hash = $state('');
  sides: readonly [Side, Side] | null = $state.raw(null);
  /** Pairs of states up to which it is searched now. */
  states: number | null = $state(null);
  answer: ComparedReport | null = $state.raw(null);
  failed = $state('');
  /** The user, or the time, has ended the search before its end. */
  stopped = $state(false);
  told: readonly [Told, Told] | null = $state.raw(null);
  /** The scan that both runs show, from 0. */
  scan = $state(0);
  playing = $state(false);
  #worker = new Local('g7-whole.wasm');
  #turn = 0;
  #walk = 0;

  /** True if the compared text is that of the visible file. */
  readonly present: boolean = $derived(files.current !== null && this.file === files.current.name && this.hash === files.current.look.hash);

  async start(file: OpenFile, sides: readonly [Side, Side], situations: boolean): Promise<void> {
    await this.end();
    const turn = ++this.#turn;
    const mine = () => turn === this.#turn;
    this.file = file.name;
    this.hash = file.look.hash;
    this.sides = sides;
    this.states = 0;
    const late = window.setTimeout(() => mine() && this.stop(), TIME);
    try {
      const opened = async (n: number, { name, text, uses }: Side) => (await this.#worker.call({ do: 'open', file: `${n}/${name}`, text, uses })).file;
      const names: [string, string] = [await opened(0, sides[0]), await opened(1, sides[1])];
      const profiles: [string | null, string | null] = [sides[0].profile, sides[1].profile];
      for (const states of ROUNDS) {
        if (!mine()) return;
        this.states = states;
        const answer = await this.#worker.call({ do: 'compare', files: names, profiles, situations, states, mib: MEMORY });
        if (!mine()) return;
        this.answer = answer;
        if (!answer.more) break;
      }
      if (this.answer?.runs) await this.#repeat(sides, this.answer.runs, mine);
    } catch (error) {
      if (mine()) this.failed = (error as Error).message;
    } finally {
      clearTimeout(late);
      if (mine()) this.states = null;
    }
  }

  /** Ends the search; how far it is sure stays. */
  stop(): void {
    if (this.states === null) return;
    this.#turn++;
    this.#worker.stop();
    this.states = null;
    this.stopped = true;
  }

  /** Forgets the comparison and its runs. */
  async end(): Promise<void> {
    this.stop();
    this.#turn++;
    this.pause();
    const told = this.told;
    this.file = this.hash = this.failed = '';
    this.sides = this.answer = this.told = null;
    this.stopped = false;
    await forget(told ?? []);
  }

  /** Repeats the runs, up to their last scan. */
  async #repeat(sides: readonly [Side, Side], runs: [ProofScan[], ProofScan[]], mine: () => boolean): Promise<void> {
    const told: Told[] = [];
    // Names of its own: a comparison that was ended meanwhile may still have to close its files.
    const folder = `\u0000compared/${this.#turn}`;
    for (const [n, side] of sides.entries()) {
      const look = await page.call({ do: 'open', file: `${folder}/${n}/${side.name}`, text: side.text, uses: side.uses });
      const started = await page.call({ do: 'run_start', file: look.file, run: look.file, plant: 'none', profile: side.profile, moves: runs[n] });
      const run = new Run(started, page, false);
      told.push({ side, look, run, lanes: await lanesOf(run) });
    }
    const [left, right] = told;
    if (!mine() || !left || !right) return forget(told);
    this.scan = Math.max(0, (this.answer?.scans ?? 1) - 1);
    this.told = [left, right];
  }

  /** Shows a scan of both runs. */
  async seek(scan: number): Promise<void> {
    const last = (this.answer?.scans ?? 1) - 1;
    const at = Math.max(0, Math.min(scan, last));
    for (const { run } of this.told ?? []) {
      const of = run.name;
      run.take(await (at === last ? page.call({ do: 'run_live', run: of }) : page.call({ do: 'run_seek', run: of, ms: at * run.started.period_ms })));
    }
    this.scan = at;
  }

  /** Plays both runs from their start, or from where they stand. */
  async play(): Promise<void> {
    const scans = this.answer?.scans ?? 1;
    const walk = ++this.#walk;
    this.playing = true;
    const seen = Math.max(60, Math.min(SEEN, WHOLE / scans));
    try {
      if (this.scan >= scans - 1) await this.seek(0);
      while (this.scan < scans - 1) {
        await new Promise((done) => setTimeout(done, seen));
        if (walk !== this.#walk) return;
        await this.seek(this.scan + 1);
      }
    } finally {
      if (walk === this.#walk) this.playing = false;
    }
  }

  pause(): void {
    this.#walk++;
    this.playing = false;
  }
}

/** Ends these runs and closes their files. */
async function forget(told: readonly Told[]): Promise<void> {
  for (const { look, run } of told) {
    await page.call({ do: 'run_stop', run: run.name });
    await page.call({ do: 'close', file: look.file });
  }
}

/** The edges of all inputs, outputs and steps of a run. */
async function lanesOf(run: Run): Promise<Lane[]> {
  const { signals, steps } = run.started;
  const shown = signals.map((s, lane) => ({ name: s.name, lane, type: s.type, step: false, role: s.role })).filter((s) => s.role === 'input' || s.role === 'output');
  const active = steps.map((s, i) => ({ name: s.activity, lane: signals.length + i, type: 'bool' as const, step: true, inner: s.inner })).filter((s) => !s.inner);
  const all = [...shown, ...active];
  const found = await run.answers.call({ do: 'run_lanes', run: run.name, signals: all.map((s) => s.lane), from_ms: 0, to_ms: run.end + run.started.period_ms, most: 4000 });
  return all.map(({ name, type, step }, i) => ({ name, type, step, edges: found.lanes[i] ?? [] }));
}

export const comparison = new Comparison();
