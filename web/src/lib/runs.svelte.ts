// The runs of the page: which message goes to whom, and what came back.
import { page, type Answers } from './page';
import type { Frame, Started } from './protocol';

/** One run, simulated in the page or held by the server. */
export class Run {
  readonly started: Started;
  readonly answers: Answers;
  frame: Frame = $state.raw(undefined as unknown as Frame);

  constructor(started: Started, answers: Answers) {
    this.started = started;
    this.answers = answers;
    this.frame = started.frame;
  }
}

class Runs {
  list: Run[] = $state.raw([]);
  current: Run | null = $state.raw(null);

  async start(file: string, run = 'a', wishes: Record<string, unknown> = {}): Promise<Run> {
    const started = await page.call<Started>({ do: 'run_start', file, run, ...wishes });
    const made = new Run(started, page);
    this.list = [...this.list.filter((r) => r.started.run !== run), made];
    this.current = made;
    return made;
  }
}

export const runs = new Runs();
