// The words of what has changed, for screen readers: short, and never a list of many.
import { t } from '../lib/i18n';
import type { Problem } from '../lib/protocol';
import type { Run } from '../lib/runs.svelte';

/** More names than this are counted. */
const MOST = 4;

/** The state of a run when it was last told. */
export interface Heard {
  run: Run;
  steps: ReadonlySet<string>;
  outputs: ReadonlyMap<string, string>;
}

export function noticed(run: Run): Heard {
  const outputs = new Map<string, string>();
  run.started.signals.forEach((signal, n) => signal.role === 'output' && outputs.set(signal.name, run.shows[n] ?? ''));
  return { run, steps: new Set(run.situation), outputs };
}

function list(names: string[]): string {
  const more = names.length - MOST;
  return names.slice(0, MOST).join(', ') + (more > 0 ? ` ${t('speech.more', { n: more })}` : '');
}

/** The steps that became active or inactive, and the outputs with another value. */
export function changed(was: Heard | null, now: Heard): string {
  const came = [...now.steps].filter((name) => !was?.steps.has(name));
  const went = [...(was?.steps ?? [])].filter((name) => !now.steps.has(name));
  const outputs = was ? [...now.outputs].filter(([name, value]) => was.outputs.get(name) !== value).map(([name, value]) => `${name} ${value}`) : [];
  return [
    came.length > 0 && t('speech.active', { names: list(came) }),
    went.length > 0 && t('speech.left', { names: list(went) }),
    outputs.length > 0 && list(outputs),
  ]
    .filter(Boolean)
    .join('; ');
}

/** The one new problem, or how many there are. */
export function counted(problems: readonly Problem[], was: ReadonlySet<string>): string {
  const fresh = problems.filter((p) => !was.has(p.what));
  const [one] = fresh;
  if (fresh.length === 0 && problems.length === was.size) return '';
  if (problems.length === 0) return t('app.noProblems');
  if (one && fresh.length === 1) return `${t(one.severity === 'error' ? 'app.error' : 'app.warning')}: ${one.what.replaceAll('`', '')}`;
  const errors = problems.filter((p) => p.severity === 'error').length;
  return [errors > 0 && t('app.errors', { n: errors }), problems.length > errors && t('app.warnings', { n: problems.length - errors })].filter(Boolean).join(', ');
}
