// What the drawing shows of a run, by item id. Whoever runs writes here; the
// canvas draws it in a layer of its own. Replace the sets, never change them.

export class Live {
  /** Whether a run is shown at all. */
  running = $state(false);
  /** Active steps. */
  on: ReadonlySet<string> = $state.raw(new Set());
  /** Time of active steps, as shown. */
  times: ReadonlyMap<string, string> = $state.raw(new Map());
  /** 1 enabled, 2 enabled and true; transitions not in it are not enabled. */
  enabled: ReadonlyMap<string, 0 | 1 | 2> = $state.raw(new Map());
  /** Values beside symbols, as shown. */
  values: ReadonlyMap<string, string> = $state.raw(new Map());
  /** Actions whose output is true. */
  lit: ReadonlySet<string> = $state.raw(new Set());
  /** Symbols that show a forced variable. */
  forced: ReadonlySet<string> = $state.raw(new Set());
  breaks: ReadonlySet<string> = $state.raw(new Set());
  /** Steps that are active only in the run that this one is compared with, and what that is called. */
  others: ReadonlySet<string> = $state.raw(new Set());
  otherName = $state('');
  /** Transitions that were cleared since the last frame. */
  cleared: readonly string[] = $state.raw([]);
  /** The symbol at which the run stopped or halted. */
  stopped: string | null = $state(null);

  clear(): void {
    this.running = false;
    this.on = new Set();
    this.times = new Map();
    this.enabled = new Map();
    this.values = new Map();
    this.lit = new Set();
    this.forced = new Set();
    this.others = new Set();
    this.cleared = [];
    this.stopped = null;
  }
}

export const live = new Live();
