// The names of symbols for screen readers.
import { actionOf, nameIn } from '../lib/ids';
import { live } from '../lib/live.svelte';
import type { Scene } from './scene';
import { t } from '../lib/i18n';
import type { Item } from '../lib/protocol';

/** The name of a symbol in a drawing, with its state in the run, and with what a step does. */
export function spokenOf(item: Item, scene: Scene | null): string {
  const active = live.on.has(item.id) && t('canvas.active');
  const actions = item.part === 'step' ? (scene?.actions.get(item.id) ?? []).map((action) => action.source ?? '') : [];
  return [nameOf(item), active, actions.length > 0 && t('canvas.does', { text: actions.join('; ') })].filter(Boolean).join(', ');
}

export function nameOf(item: Item): string {
  const with_ = (name: string) => (item.comment ? `${name} — ${item.comment}` : name);
  switch (item.part) {
    case 'step': {
      const key = item.macro
        ? 'canvas.macro'
        : item.encloses?.length
          ? 'canvas.enclosing'
          : item.initial
            ? 'canvas.initialStep'
            : 'canvas.step';
      return with_(t(key, { name: item.name ?? '' }));
    }
    case 'transition':
      return with_(
        item.label
          ? t('canvas.transition', { name: item.label, text: item.source ?? '' })
          : t('canvas.transitionOf', { text: item.source ?? '' }),
      );
    case 'action':
      return t('canvas.action', { name: nameIn(actionOf(item.id)?.step ?? ''), text: item.source ?? '' });
    case 'connector':
      return t('canvas.connector', { name: item.name ?? nameIn(item.ends?.[1] ?? '') });
    case 'title':
      return with_(t('canvas.name', { name: item.name ?? '' }));
    case 'comment':
      return t('canvas.comment', { text: item.comment ?? '' });
    case 'link':
      return t('canvas.link');
    case 'text':
      return item.comment ?? '';
  }
}
