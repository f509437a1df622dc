// The macro-steps and enclosing steps whose charts are drawn beside the chart in which they stand. It is a state of the
// view: no file keeps it.

class Opened {
  /** The ids of the steps, by file and chart. */
  #steps: ReadonlyMap<string, readonly string[]> = $state.raw(new Map());

  of(file: string, chart: string): readonly string[] {
    return this.#steps.get(`${file}\n${chart}`) ?? [];
  }

  /** Opens a step in the drawing of a chart, or closes it again. */
  toggle(file: string, chart: string, step: string): void {
    const was = this.of(file, chart);
    const now = was.includes(step) ? was.filter((s) => s !== step) : [...was, step];
    this.#steps = new Map(this.#steps).set(`${file}\n${chart}`, now);
  }
}

export const opened = new Opened();
