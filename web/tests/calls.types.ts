// Calls that the types refuse, each with its fault. It never runs: `npm run check` reads it, and complains of a
// line that is not wrong.
import { page } from '../src/lib/page';
import { runs } from '../src/lib/runs.svelte';
import { server } from '../src/lib/server';
import type { Run } from '../src/run/state.svelte';

export async function refused(run: Run): Promise<void> {
  // @ts-expect-error no text
  await page.call({ do: 'open', file: 'a.g7' });
  // @ts-expect-error no such message
  await page.call({ do: 'opne', file: 'a.g7', text: '' });
  // @ts-expect-error a field of no meaning
  await page.call({ do: 'open', file: 'a.g7', text: '', more: 1 });
  // @ts-expect-error the answer of another message
  (await page.call({ do: 'open', file: 'a.g7', text: '' })).css;
  // @ts-expect-error a signal is a number
  await page.call({ do: 'run_set', run: 'a', signal: 'x', value: '1' });
  // @ts-expect-error no frame comes back
  await runs.send(run, { do: 'run_stop' });
  // @ts-expect-error no speed
  await server.call({ do: 'pace', run: 'a' });
  // @ts-expect-error the server answers for runs only
  await server.call({ do: 'open', file: 'a.g7', text: '' });
  // @ts-expect-error the page has the text of its files
  await page.call({ do: 'run_start', run: 'a', file: 'a.g7', text: '', uses: [] });
}

export async function taken(run: Run): Promise<string> {
  await runs.send(run, { do: 'run_seek', ms: 1 });
  const shared = await server.call({ do: 'run_start', run: 'a', file: 'a.g7', text: '', uses: [] });
  const swapped = await page.call({ do: 'run_swap', run: 'a', file: 'a.g7' });
  return 'lost' in swapped ? swapped.lost.join() : `${swapped.profile} ${shared.speed}`;
}
