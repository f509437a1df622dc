// The variables and steps of the visible file, as the checker knows them.
import { files } from '../lib/files.svelte';
import { page } from '../lib/page';
import type { Symbols, VariableRow } from '../lib/protocol';

/** Follows the visible file; call inside a component. */
export function symbols(): { readonly rows: VariableRow[]; readonly stale: boolean } {
  let found: Symbols = $state.raw({ stale: false, variables: [], steps: [] });
  let of = '';
  $effect(() => {
    const file = files.current;
    if (!file) return;
    const { look } = file;
    if (of !== file.name) found = { stale: false, variables: [], steps: [] };
    of = file.name;
    page.call({ do: 'symbols', file: file.name }).then(
      (answer) => {
        if (file.look === look && files.current === file) found = answer;
      },
      () => undefined,
    );
  });
  return {
    get rows() {
      return found.variables;
    },
    get stale() {
      return found.stale ?? false;
    },
  };
}
