// The panel *Why*: a question about a run, and its answer. The run gives its record, and the module that has everything answers.
import { files } from '../lib/files.svelte';
import { t } from '../lib/i18n';
import { chartOf } from '../lib/ids';
import { choices } from '../lib/instances.svelte';
import { page } from '../lib/page';
import type { Because } from '../lib/protocol';
import type { Run } from '../lib/runs.svelte';
import { shell } from '../lib/shell.svelte';

/** A question: about a symbol or a name, or about a whole scan. */
interface Question {
  run: Run;
  about: string | null;
  /** The instant of the scan, in ms. */
  ms: number;
}

class WhyPanel {
  question: Question | null = $state.raw(null);
  answer: Because | null = $state.raw(null);
  failed = $state('');
  busy = $state(false);
  #turn = 0;

  /** Asks about what the run shows now, and opens the panel. */
  async ask(run: Run, about: string | null): Promise<void> {
    const turn = ++this.#turn;
    const ms = run.now;
    shell.below('why');
    this.question = { run, about, ms };
    this.answer = null;
    this.failed = '';
    this.busy = true;
    try {
      const answer = await answered({ run, about, ms });
      if (turn === this.#turn) this.answer = answer;
    } catch (error) {
      if (turn === this.#turn) this.failed = (error as Error).message;
    } finally {
      if (turn === this.#turn) this.busy = false;
    }
  }
}

/** The instance that the drawing shows of the chart of a symbol, if that has parameters. */
function instanceOf(run: Run, about: string | null): string | null {
  const chart = about === null ? '' : chartOf(about);
  return run.instances.has(chart) ? choices.of(run.file, chart, run.instances) : null;
}

async function answered({ run, about, ms }: Question): Promise<Because> {
  const file = files.find(run.file);
  if (!file || file.look.hash !== run.hash) throw new Error(t('why.changed'));
  const { text, name } = file;
  const uses = await file.used();
  const { text: tape } = await run.answers.call({ do: 'run_tape', run: run.name });
  const { profile, period_ms, plant } = run.started;
  return page.call({ do: 'why', file: name, run: run.name, profile, scan_ms: period_ms, plant: plant ?? 'none', text, uses, tape, about, instance: instanceOf(run, about), ms });
}

export const why = new WhyPanel();
