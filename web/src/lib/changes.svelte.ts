// Work that follows the changes of open files.
import { files, type OpenFile } from './files.svelte';

/** Calls a function with each open file that has changed, so many ms after the change; changes meanwhile are one with it.
 * `read` reads what counts as a change. Call once, inside a component. */
export function afterChanges(ms: number, read: (file: OpenFile) => unknown, then: (file: OpenFile) => void): void {
  const waiting = new Set<OpenFile>();
  $effect(() => {
    for (const file of files.list) {
      // Read here, so that this is done anew after each change of it.
      read(file);
      if (waiting.has(file)) continue;
      waiting.add(file);
      setTimeout(() => {
        waiting.delete(file);
        then(file);
      }, ms);
    }
  });
}
