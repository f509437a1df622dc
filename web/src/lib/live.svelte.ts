// The marks of a run on the drawing, by item id. The code that runs charts writes here; the canvas
// draws the marks in a layer of their own. Replace the sets, never change them.

export class Live {
  /** True if a run is shown. */
  running = $state(false);
  /** The active steps. */
  on: ReadonlySet<string> = $state.raw(new Set());
  /** The time of each active step, as shown. */
  times: ReadonlyMap<string, string> = $state.raw(new Map());
  /** 1 enabled, 2 enabled and the receptivity is true; transitions that are not enabled are absent.
   * */
  enabled: ReadonlyMap<string, 0 | 1 | 2> = $state.raw(new Map());
  /** The values beside symbols, as shown. */
  values: ReadonlyMap<string, string> = $state.raw(new Map());
  /** The actions whose output is true. */
  lit: ReadonlySet<string> = $state.raw(new Set());
  /** The symbols that name a forced variable. */
  forced: ReadonlySet<string> = $state.raw(new Set());
  breaks: ReadonlySet<string> = $state.raw(new Set());
  /** The steps that are active only in the run that this one is compared with, and the name of that
   * run. */
  others: ReadonlySet<string> = $state.raw(new Set());
  otherName = $state('');
  /** The transitions cleared since the last frame. */
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
