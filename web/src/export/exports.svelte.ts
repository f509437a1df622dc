// The exported chart, updated when the chart changes.
import { files } from '../lib/files.svelte';
import { page } from '../lib/page';
import type { Form, Out } from '../lib/protocol';

class Exports {
  forms: Form[] = $state.raw([]);
  word: string = $state('');
  /** The answer of the page, if it was not a refusal. */
  made: Out | null = $state.raw(null);
  refused: string = $state('');
  #asked = 0;

  async list(): Promise<void> {
    if (this.forms.length > 0) return;
    this.forms = await page.call({ do: 'forms' });
    this.word ||= this.forms[0]?.word ?? '';
  }

  /** Makes the export; an outdated answer is ignored. */
  async make(): Promise<void> {
    const file = files.current;
    if (!file || this.word === '') return;
    const asked = ++this.#asked;
    try {
      const made = await page.call({ do: 'export', file: file.name, to: this.word });
      if (asked !== this.#asked) return;
      this.made = made;
      this.refused = '';
    } catch (error) {
      if (asked !== this.#asked) return;
      this.made = null;
      this.refused = (error as Error).message;
    }
  }
}

export const exports = new Exports();
