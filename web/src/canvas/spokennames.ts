// The names of symbols for screen readers.
import { actionOf, nameIn } from '../lib/ids';
import { t } from '../lib/i18n';
import type { Item } from '../lib/protocol';

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
    case 'comment':
      return t('canvas.comment', { text: item.comment ?? '' });
    case 'link':
      return t('canvas.link');
    case 'text':
      return item.comment ?? '';
  }
}
