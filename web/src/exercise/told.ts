// The result of a check in sentences: for the panel and for screen readers.
import { t } from '../lib/i18n';
import { prefs } from '../lib/prefs.svelte';
import type { ExerciseChecked } from '../lib/protocol';

/** A time as a reader counts it. */
export const seconds = (ms: number) => `${new Intl.NumberFormat(prefs.language, { maximumFractionDigits: 3 }).format(ms / 1000)} s`;

/** The result in one sentence, and what is left open. */
export function summary({ mark, tests, questions }: ExerciseChecked): string[] {
  const failed = (hidden: boolean) => tests.filter((one) => one.hidden === hidden && !one.ok).length;
  const refuted = (hidden: boolean) => questions.filter((one) => one.hidden === hidden && one.verdict === 'refuted').length;
  const open = questions.filter((one) => one.verdict === 'open').length;
  const head = {
    passed: t('exercise.passed', { n: tests.length }),
    changed: t('exercise.changed'),
    fitted: t('exercise.fitted', { tests: failed(true), questions: refuted(true) }),
    failed: t('exercise.failed', { tests: failed(false) + failed(true), of: tests.length, questions: refuted(false) + refuted(true) }),
    unread: t('exercise.unread'),
  }[mark];
  return open > 0 ? [head, t('exercise.open', { n: open })] : [head];
}
