// The events and reasons of a controller in the language of the page.
import { t, type Key } from '../lib/i18n';
import type { Event, Reason } from './told';

export function reasonOf(reason: Reason): string {
  if (reason.kind === 'watchdog') return t('op.watchdog');
  if (reason.kind === 'input') return t('op.badInput', { name: reason.name ?? '' });
  return t('op.halt', { why: reason.why ?? '' });
}

export function textOf(event: Event): string {
  const why = event.reason ? reasonOf(event.reason) : (event.why ?? '');
  const kind = event.master && (event.kind === 'up' || event.kind === 'down') ? (event.kind === 'up' ? 'masterUp' : 'masterDown') : event.kind;
  return t(`op.ev.${kind}` as Key, { why, name: event.name ?? '', value: event.value ?? '', device: event.device ?? '', n: event.count ?? 0 });
}
