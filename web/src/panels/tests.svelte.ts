// The latest results of the tests; they stay while other panels are in front.
import type { OpenFile } from '../lib/files.svelte';
import { page } from '../lib/page';
import type { TestAnswer, TestResult, TestWhy } from '../lib/protocol';

class Tests {
  busy = $state(false);
  /** The file and the state of its text that were tested. */
  file = $state('');
  hash = $state('');
  /** By name. */
  results: ReadonlyMap<string, TestResult> = $state.raw(new Map());
  /** Of all tests together; none where only some of them were run. */
  answer: TestAnswer | null = $state.raw(null);

  /** Why tests failed, by their names; those that were asked. */
  reasons: ReadonlyMap<string, TestWhy> = $state.raw(new Map());

  /** Asks why a test failed. Without an answer the text is another one by now. */
  async why(file: OpenFile, name: string): Promise<TestWhy | undefined> {
    await file.settled();
    const { hash } = this;
    if (file.look.hash !== hash) return undefined;
    const found = this.reasons.get(name) ?? (await page.call({ do: 'test_why', file: file.name, name }));
    if (this.hash === hash) this.reasons = new Map([...this.reasons, [name, found]]);
    return found;
  }

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
      this.reasons = new Map();
      this.file = file.name;
      this.hash = hash;
      return answer;
    } finally {
      this.busy = false;
    }
  }
}

export const tests = new Tests();
