// The words of the server about kinds, settings and points, in the language of the page.
import { prefs } from '../lib/prefs.svelte';
import { abouts } from '../lib/words/wiring';

export function about(text: string): string {
  const found = abouts[text];
  return prefs.language === 'en' || !found ? text : found[prefs.language === 'fr' ? 0 : 1];
}
