// The latest results of the tests; they stay while other panels are in front.
import type { OpenFile } from '../lib/files.svelte';
import { page } from '../lib/page';
import type { TestAnswer, TestResult } from '../lib/protocol';

class Tests {
  busy = $state(false);
  /** The file and the state of its text that were tested. */
  file = $state('');
  hash = $state('');
  /** By name. */
  results: ReadonlyMap<string, TestResult> = $state.raw(new Map());
  /** Of all tests together; none where only some of them were run. */
  answer: TestAnswer | null = $state.raw(null);

  /** Runs all tests of a file, or one. */
  async run(file: OpenFile, name?: string): Promise<TestAnswer | undefined> {
    if (this.busy) return undefined;
    this.busy = true;
    try {
      await file.settled();
      const { hash } = file.look;
      const answer = await page.call({ do: 'test', file: file.name, ...(name === undefined ? {} : { name }) });
      const same = this.file === file.name && this.hash === hash;
      const before = same && name !== undefined ? this.results : [];
      this.results = new Map([...before, ...answer.tests.map((r): [string, TestResult] => [r.name, r])]);
      if (name === undefined) this.answer = answer;
      else if (!same) this.answer = null;
      this.file = file.name;
      this.hash = hash;
      return answer;
    } finally {
      this.busy = false;
    }
  }
}

export const tests = new Tests();
