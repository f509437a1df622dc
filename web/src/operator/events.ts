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
  let kind: string = event.kind;
  if (event.master && (kind === 'up' || kind === 'down')) kind = kind === 'up' ? 'masterUp' : 'masterDown';
  if (why && (kind === 'changed' || kind === 'back')) kind += 'Lost';
  if (event.who && (kind === 'pressed' || kind === 'set')) kind += 'By';
  return t(`op.ev.${kind}` as Key, { why, name: event.name ?? '', value: event.value ?? '', device: event.device ?? '', n: event.count ?? 0, who: event.who ?? '' });
}
