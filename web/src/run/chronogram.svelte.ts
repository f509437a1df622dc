// The signals of the chronogram, its span of time and its cursors. They are kept while the panel is
// closed; edges are loaded when they become visible.
import { shell } from '../lib/shell.svelte';
import { handOut } from '../frame/actions';
import { base } from '../lib/paths';
import type { SignalType } from '../lib/protocol';
import type { Lane, Span } from './lanes';
import type { Run } from './state.svelte';

/** A signal or a step, by its name, which stays when the chart changes. */
export interface Source {
  name: string;
  lane: number;
  type: SignalType;
  step: boolean;
}

const FIRST = 14;

class Chronogram {
  /** The chosen names of each file. */
  #picked: Map<string, readonly string[]> = $state.raw(new Map());
  span: Span = $state.raw({ from: 0, to: 10_000 });
  /** The window follows the present. */
  following = $state(true);
  a: number | null = $state(null);
  b: number | null = $state(null);
  table = $state(false);
  lanes: Lane[] = $state.raw([]);
  #busy = false;
  #again = false;

  /** Everything that can be chosen. */
  sources(run: Run): Source[] {
    const signals = run.started.signals.map((s, lane) => ({ name: s.name, lane, type: s.type, step: false }));
    const from = signals.length;
    return signals.concat(run.started.steps.map((s, i) => ({ name: s.activity, lane: from + i, type: 'bool' as const, step: true })));
  }

  picked(run: Run): Source[] {
    const all = this.sources(run);
    const names = this.#picked.get(run.file) ?? this.#first(run);
    const byName = new Map(all.map((s) => [s.name, s]));
    return names.flatMap((name) => byName.get(name) ?? []);
  }

  /** The first choice: inputs and outputs, and as many steps as fit. */
  #first(run: Run): string[] {
    const io = run.started.signals.filter((s) => s.role === 'input' || s.role === 'output').map((s) => s.name);
    const steps = run.started.steps.filter((s) => !s.inner).map((s) => s.activity);
    return [...io.slice(0, FIRST), ...steps].slice(0, Math.max(FIRST, Math.min(io.length, FIRST) + 4));
  }

  pick(run: Run, names: readonly string[]): void {
    this.#picked = new Map(this.#picked).set(run.file, names);
  }

  zoom(by: number, about: number): void {
    const { from, to } = this.span;
    const width = Math.min(Math.max((to - from) * by, 1), 1e10);
    const share = (about - from) / (to - from);
    this.span = { from: about - width * share, to: about + width * (1 - share) };
  }

  pan(ms: number): void {
    this.following = false;
    this.span = { from: this.span.from + ms, to: this.span.to + ms };
  }

  whole(run: Run): void {
    this.following = false;
    this.span = { from: 0, to: Math.max(run.end * 1.02, run.started.period_ms * 10) };
  }

  /** Keeps the present near the right end; while the run shows an instant of the past, keeps that in sight. */
  along(run: Run): void {
    const width = this.span.to - this.span.from;
    if (!run.live) {
      const from = Math.max(0, run.now - width / 2);
      if (run.now < this.span.from || run.now > this.span.to) this.span = { from, to: from + width };
      return;
    }
    if (!this.following) return;
    const to = Math.max(width, run.end + width * 0.06);
    if (to !== this.span.to) this.span = { from: to - width, to };
  }

  /** Loads the visible edges; requests during the loading are combined into one. */
  async fetch(run: Run, width: number): Promise<void> {
    if (this.#busy) {
      this.#again = true;
      return;
    }
    this.#busy = true;
    const picked = this.picked(run);
    try {
      const answer = await run.answers.call({
        do: 'run_lanes',
        run: run.name,
        signals: picked.map((s) => s.lane),
        from_ms: Math.max(0, this.span.from - (this.span.to - this.span.from) * 0.2),
        to_ms: this.span.to + (this.span.to - this.span.from) * 0.2,
        most: Math.max(500, Math.round(width * 1.5)),
      });
      this.lanes = picked.map((s, i) => ({ name: s.name, type: s.type, step: s.step, edges: answer.lanes[i] ?? [] }));
    } catch {
      // The run was changed or ended meanwhile; later requests load again.
    } finally {
      this.#busy = false;
      if (this.#again) {
        this.#again = false;
        void this.fetch(run, width);
      }
    }
  }

  async export(run: Run, as: 'csv' | 'vcd' | 'svg'): Promise<void> {
    const signals = this.picked(run).map((s) => s.lane);
    const span = as === 'svg' ? { from_ms: Math.max(0, this.span.from), to_ms: Math.min(run.end, this.span.to) } : {};
    await shell.try(async () => {
      const { text } = await run.answers.call({ do: 'run_export', run: run.name, signals, as, ...span });
      const name = base(run.file).replace(/\.g7$/, '');
      handOut(`${name}.${as}`, text, as === 'svg' ? 'image/svg+xml' : as === 'csv' ? 'text/csv' : 'text/plain');
    });
  }
}

export const chronogram = new Chronogram();
