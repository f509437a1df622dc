// Waits for a change of the page's state without a look at it in each frame, which would be measured too.
import { untrack } from 'svelte';

/** Ends once a value, read from the page's state, is another than now. */
export function changed(value: () => unknown): Promise<void> {
  const before = untrack(value);
  return new Promise((done) => {
    const stop = $effect.root(() => {
      $effect(() => {
        if (value() === before) return;
        done();
        queueMicrotask(stop);
      });
    });
  });
}
