// The names of people, as the page writes them.
import { t } from '../lib/i18n';
import type { Person } from '../lib/server';

export const named = (person: Person): string => person.name || t('tog.nobody');

/** The letters that stand for a name where there is little room. */
export function initials(person: Person): string {
  const words = person.name.split(/\s+/).filter(Boolean);
  const letters = words.length > 1 ? [words[0], words.at(-1)].map((word) => [...(word ?? '')][0]) : [...(words[0] ?? '?')].slice(0, 2);
  return letters.join('').toUpperCase();
}
